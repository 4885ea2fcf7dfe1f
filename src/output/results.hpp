// Writes a result file: what ParaView reads in /VTKHDF, all the rest in /talus. Layout: docs/results-format.md.
//
// Every frame ends with one flush, and counts only then. A kill at any other moment leaves the frames completed before; a
// write that fails (disk full) throws OutputError, leaves them too, and nothing more is written.
#pragma once

#include "model/measure.hpp"
#include "model/model.hpp"
#include "model/state.hpp"
#include "model/verdict.hpp"
#include "output/h5_file.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace talus {

struct ScenarioInfo {  // which scenario: enough to read it again
    std::string scenario_file, scenario_text;
    std::uint64_t scenario_hash = 0;
    std::vector<std::string> overrides;  // as given to --set
};

struct RunInfo : ScenarioInfo {  // provenance: enough to run the same again
    std::string title, source, canonical_json;
    std::vector<std::pair<std::string, std::uint64_t>> files;  // that the scenario names; FNV-1a of what was in them
    std::string solver, search;
    int threads = 1;
    double skin = 0.0;                                                  // m
    double time_step = 0.0, stable_bound = 0.0, stable_estimate = 0.0;  // s
    std::string start_date;                                             // ISO 8601
    bool contacts = true;                                               // write the contacts of every frame
};

struct RunSummary {
    std::string status;      // complete | interrupted | diverged | stopped | refused
    double wall_time = 0.0;  // s
    double cpu_time = 0.0;   // s, of all threads, from the first step on and without recording
    std::int64_t steps = 0;
    double end_time = 0.0;                      // s
    double energy_gain = 0.0;                   // 1
    Statics statics;                            // evidence of the static stages
    std::optional<StabilityVerdict> verdict{};  // none: the run ended before anything could be said
};

struct HistoryColumn {
    std::string name, unit;
};

using HistoryRows = std::vector<std::pair<std::string, std::int64_t>>;  // history and how many rows it has

class ResultsWriter {
public:
    /// Replaces the file, and removes the restart file beside it, which belongs to an earlier run. Throws InputError.
    ResultsWriter(const std::string& path, const Model& model, const RunInfo& info);

    /// Goes on with a file after cutting it back to the frames and history rows it had at a restart point.
    /// Throws InputError if the file is not that of the run with this hash, or has less than that.
    static ResultsWriter reopen(const std::string& path, std::uint64_t scenario_hash, std::int64_t frames,
                                const HistoryRows& rows);

    void frame(const Model& model, const State& state, const Energies& energies);

    /// Number of the history, for `append_history`. After `reopen` the same call finds the history again.
    /// Throws InputError if a name is empty, is twice there, contains a slash, or is `time`.
    int add_history(const std::string& name, const std::vector<HistoryColumn>& columns);
    void append_history(int history, double time, std::span<const double> values);

    /// Writes what histories still hold in memory; for the moments between frames.
    void flush();
    void finish(const RunSummary& summary);

    std::int64_t frames() const { return frames_; }
    HistoryRows history_rows() const;  // including rows in memory; write a restart after `flush`
    const std::string& path() const { return file_.path(); }

private:
    struct History {
        std::string name;
        std::vector<std::string> paths;            // datasets: time and columns
        std::vector<std::vector<double>> waiting;  // rows not yet in the file, by column
        std::int64_t rows = 0;                     // in the file
    };
    explicit ResultsWriter(h5::File file) : file_(std::move(file)) {}
    void append_histories();
    void append_contacts(const Model& model, const State& state);
    void write_evidence(const Statics& statics);
    void write_verdict(const StabilityVerdict& verdict);

    h5::File file_;
    std::int64_t frames_ = 0, contact_rows_ = 0;
    bool contacts_ = true;
    std::vector<History> histories_;
};

}  // namespace talus
