// A whole run: stage after stage, with what is recorded on the way.
#pragma once

#include "output/restart.hpp"
#include "output/results.hpp"
#include "simulation/expect.hpp"
#include "simulation/simulation.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace talus {

enum class Outcome { complete, no_equilibrium, interrupted };

/// Where a run writes. Recording begins with the first stage after the last one that resets: results start at time 0.
class Recorder {
public:
    /// Replaces the file. Throws InputError if it cannot be written or a history fits nothing.
    Recorder(const std::string& path, const Simulation& simulation, const std::vector<std::string>& overrides);
    /// Goes on after a restart point.
    Recorder(const std::string& path, const Simulation& simulation, const RestartInfo& info);

    void begin_stage(const Simulation& simulation);  // a frame if the clock has just been set
    void after_step(const Simulation& simulation);   // what is due by now
    void end_stage(const Simulation& simulation);    // a frame of its end, and a restart file between stages
    void write_frame(const Simulation& simulation, const State& state);  // now, due or not
    void save_restart(const Simulation& simulation);
    void close(const std::string& status);  // without a restart file
    /// With a restart file of this moment, unless the run diverged or a stage was refused: then the one before stays.
    void finish(const Simulation& simulation, const std::string& status, double wall_time);

    std::int64_t frames() const { return writer_.frames(); }
    const std::string& path() const { return writer_.path(); }
    std::string restart_file() const;

private:
    struct History {
        std::vector<Probe> probes;
        std::optional<double> every;
        double last = 0.0;  // s, of its last row
        int id = 0;
    };
    void add_histories(const Simulation& simulation);
    void frame_and_restart(const Simulation& simulation);
    void sample(const Simulation& simulation, History& history);
    void sample_all(const Simulation& simulation);

    RestartInfo info_;
    ResultsWriter writer_;
    std::vector<History> histories_;
    double frame_every_ = 0.0;       // s; 0: only at the ends of stages
    double last_frame_time_ = -1.0;  // s
    Stopwatch since_restart_;
    CpuStopwatch cpu_;
    double cpu_of_recording_ = 0.0;  // s
    bool restart_written_ = false;
};

/// Throws InputError with every history and expectation that observes what is not there; before any file is touched.
void check_probes(const Simulation& simulation);

enum class Entry {
    fresh,    // nothing has been done yet
    begun,    // the first stage has begun (its time step was accepted)
    resumed,  // in the middle of a stage
};

struct RunOptions {
    Recorder* recorder = nullptr;                        // none: nothing is written
    Watch* watch = nullptr;                              // none: expectations are not judged
    std::function<void(const Simulation&)> stage_begun;  // after its step is chosen
    std::function<void(const Simulation&)> progress;     // called every step; cheap
    std::function<bool()> interrupted;                   // asked every step
    Entry entry = Entry::fresh;
};

/// Runs to the end of the last stage. `no_equilibrium`: a stage that was to end in equilibrium ran out of time
/// (State::unsettled), be it before the run was resumed.
/// Throws DivergenceError, after a last look at everything worth keeping: the good frames stay. Throws InputError if a stage
/// cannot begin; the restart file is then that of the end of the one before.
Outcome run(Simulation& simulation, const RunOptions& options);

}  // namespace talus
