#include "simulation/run.hpp"

#include "core/errors.hpp"
#include "output/output_path.hpp"
#include "output/reader.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace talus {
namespace {

constexpr double restart_interval = 5.0;  // s of wall time between restart files: a kill costs no more than that
constexpr int default_frames = 50;

std::string now_iso() {
    const std::time_t now = std::time(nullptr);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
    return text;
}

ScenarioInfo scenario_info(const Simulation& simulation, const std::vector<std::string>& overrides) {
    const Scenario& scenario = simulation.scenario();
    return {scenario.file, scenario.text, scenario.hash, overrides};
}

RunInfo run_info(const Simulation& simulation, const std::vector<std::string>& overrides) {
    const Scenario& scenario = simulation.scenario();
    RunInfo info;
    static_cast<ScenarioInfo&>(info) = scenario_info(simulation, overrides);
    info.title = scenario.title;
    info.source = scenario.source;
    info.canonical_json = scenario.canonical_json;
    info.files = scenario.files;
    info.solver = simulation.stage().solver;
    info.search = scenario.run.search;
    info.threads = scenario.run.threads;
    info.skin = simulation.skin();
    info.time_step = simulation.time_step();
    info.stable_bound = simulation.stable().bound;
    info.stable_estimate = simulation.stable().estimate;
    info.start_date = now_iso();
    info.contacts = scenario.record.contacts;
    return info;
}

double default_interval(const Simulation& simulation) {
    const RecordSpec& record = simulation.scenario().record;
    if (record.frame_every) return *record.frame_every;
    const double length = simulation.recorded_time();
    return length / record.frame_count.value_or(default_frames);
}

Gauges gauges_of(const Simulation& simulation, bool energies) {
    Gauges gauges;
    if (energies) gauges.energies = simulation.energies();
    gauges.time_step = simulation.time_step();
    gauges.stable_step = simulation.stable().estimate;
    gauges.energy_gain = simulation.energy_gain();
    return gauges;
}

// Due at or after a multiple of the interval; the slack absorbs the rounding of summed steps.
constexpr double slack = 1e-9;
double next_multiple(double time, double every) { return every * (std::floor(time / every * (1.0 + slack)) + 1.0); }
bool due(double time, double last, double every) { return time >= next_multiple(last, every) * (1.0 - slack); }

double last_time(const std::string& path, std::int64_t frames) {
    return frames > 0 ? ResultsReader(path).frame_times().at(static_cast<std::size_t>(frames - 1)) : -1.0;
}

}  // namespace

Recorder::Recorder(const std::string& path, const Simulation& simulation, const std::vector<std::string>& overrides)
    : info_{scenario_info(simulation, overrides)},
      writer_(path, simulation.model(), run_info(simulation, overrides)),
      frame_every_(default_interval(simulation)) {
    add_histories(simulation);
}

Recorder::Recorder(const std::string& path, const Simulation& simulation, const RestartInfo& info)
    : info_(info),
      writer_(ResultsWriter::reopen(path, info.scenario_hash, info.frames, info.history_rows)),
      frame_every_(default_interval(simulation)),
      last_frame_time_(last_time(path, info.frames)) {
    add_histories(simulation);
    auto memory = info_.memory.begin();
    for (History& history : histories_) {
        history.last = simulation.state().time;  // what was due by now has been written
        for (const Probe& probe : history.probes)
            if (probe.memory && memory != info_.memory.end()) probe.memory->restore(*memory++);
    }
}

void Recorder::add_histories(const Simulation& simulation) {
    const State start = simulation.first_state();
    for (const HistorySpec& spec : simulation.scenario().record.history) {
        History history;
        std::vector<HistoryColumn> columns;
        for (const ProbeSpec& probe : spec.probes) {
            history.probes.push_back(make_probe(probe, simulation.model(), start));
            columns.push_back({history.probes.back().name, history.probes.back().unit});
        }
        history.every = spec.every;
        history.id = writer_.add_history(spec.name, columns);
        histories_.push_back(std::move(history));
    }
}

void Recorder::write_frame(const Simulation& simulation, const State& state) {
    const CpuStopwatch recording;
    writer_.frame(simulation.model(), state, simulation.energies());
    last_frame_time_ = state.time;
    cpu_of_recording_ += recording.seconds();
}

void Recorder::frame_and_restart(const Simulation& simulation) {
    write_frame(simulation, simulation.state());
    if (!restart_written_ || since_restart_.seconds() > restart_interval) save_restart(simulation);
}

void Recorder::sample(const Simulation& simulation, History& history) {
    const bool energies =
        std::any_of(history.probes.begin(), history.probes.end(), [](const Probe& p) { return p.needs_energies; });
    const Gauges gauges = gauges_of(simulation, energies);
    std::vector<double> values;
    for (const Probe& probe : history.probes) values.push_back(probe.read(simulation.model(), simulation.state(), gauges));
    writer_.append_history(history.id, simulation.state().time, values);
    history.last = simulation.state().time;
}

void Recorder::sample_all(const Simulation& simulation) {
    for (History& history : histories_) sample(simulation, history);
}

void Recorder::begin_stage(const Simulation& simulation) {
    if (!simulation.recorded() || last_frame_time_ >= simulation.state().time) return;
    if (!simulation.timeless()) sample_all(simulation);  // else nothing is in balance yet: the row is that of its end
    frame_and_restart(simulation);
}

void Recorder::after_step(const Simulation& simulation) {
    if (simulation.timeless()) {  // places on the way to equilibrium are no results, but a kill should not cost them
        if (!restart_written_ || since_restart_.seconds() > restart_interval) save_restart(simulation);
        return;
    }
    if (!simulation.recorded()) return;
    const double time = simulation.state().time;
    for (History& history : histories_)
        if (!history.every || due(time, history.last, *history.every)) sample(simulation, history);
    if (frame_every_ > 0.0 && due(time, last_frame_time_, frame_every_)) frame_and_restart(simulation);
}

void Recorder::end_stage(const Simulation& simulation) {
    const int stage = simulation.state().stage;
    // A run that is resumed where a static stage had just ended has its row already.
    const bool rest = simulation.timeless() && info_.stages_recorded <= stage;
    info_.stages_recorded = stage + 1;
    if (simulation.recorded() && rest) sample_all(simulation);
    if (simulation.recorded() && (rest || last_frame_time_ < simulation.state().time)) frame_and_restart(simulation);
    if (stage + 1 < simulation.stage_count()) save_restart(simulation);  // the next one may be refused
}

void Recorder::save_restart(const Simulation& simulation) {
    const CpuStopwatch recording;
    writer_.flush();
    info_.frames = writer_.frames();
    info_.history_rows = writer_.history_rows();
    info_.memory.clear();
    for (const History& history : histories_)
        for (const Probe& probe : history.probes)
            if (probe.memory) info_.memory.push_back(probe.memory->values());
    write_restart(restart_file(), info_, simulation.state());
    restart_written_ = true;
    since_restart_.lap();
    cpu_of_recording_ += recording.seconds();
}

void Recorder::finish(const Simulation& simulation, const std::string& status, double wall_time) {
    const double cpu_time = cpu_.seconds() - cpu_of_recording_;
    std::optional<StabilityVerdict> verdict;
    if (status != "diverged" && status != "refused") {
        save_restart(simulation);
        verdict = simulation.verdict();
    }
    writer_.finish({status, wall_time, cpu_time, simulation.state().total_steps, simulation.state().time,
                    simulation.energy_gain(), simulation.state().statics, verdict});
}

void Recorder::close(const std::string& status) {
    RunSummary summary;
    summary.status = status;
    writer_.finish(summary);
}

std::string Recorder::restart_file() const { return restart_path(path()); }

void check_probes(const Simulation& simulation) {
    std::vector<ProbeSpec> probes, blocks;
    for (const HistorySpec& history : simulation.scenario().record.history)
        probes.insert(probes.end(), history.probes.begin(), history.probes.end());
    for (const ExpectSpec& expect : simulation.scenario().expect) {
        if (about_the_verdict(expect) && (expect.probe.point || !expect.probe.block.empty())) blocks.push_back(expect.probe);
        if (about_what_is_told(expect)) continue;
        probes.push_back(expect.probe);
        if (expect.against) probes.push_back(*expect.against);
    }
    const State start = simulation.first_state();
    std::vector<Fault> faults;
    const auto check = [&](const ProbeSpec& probe, auto&& find) {
        try {
            find(probe, simulation.model(), start);
        } catch (const InputError& error) {
            const Fault& found = error.faults().front();  // a history reads several quantities at one place: said once
            if (faults.empty() || faults.back().key != found.key || faults.back().message != found.message)
                faults.push_back(found);
        }
    };
    for (const ProbeSpec& probe : probes) check(probe, make_probe);
    for (const ProbeSpec& probe : blocks) check(probe, observed_block);
    if (!faults.empty()) throw InputError(std::move(faults));
}

Outcome run(Simulation& simulation, const RunOptions& options) {
    const auto watch = [&] {
        if (options.watch && simulation.recorded())
            options.watch->record(simulation.model(), simulation.state(),
                                  gauges_of(simulation, options.watch->needs_energies()));
    };
    for (Entry entry = options.entry;; entry = Entry::fresh) {
        if (entry == Entry::fresh) simulation.begin_stage();
        if (entry != Entry::resumed) {
            if (options.stage_begun) options.stage_begun(simulation);
            if (options.recorder) options.recorder->begin_stage(simulation);
            watch();
        }
        while (!simulation.stage_over()) {
            if (options.interrupted && options.interrupted()) return Outcome::interrupted;
            simulation.step();
            if (options.recorder) options.recorder->after_step(simulation);
            if (!simulation.timeless()) watch();
            if (options.progress) options.progress(simulation);
        }
        if (simulation.timeless()) watch();
        if (options.recorder) options.recorder->end_stage(simulation);
        if (!simulation.end_stage()) break;
    }
    return simulation.state().unsettled.empty() ? Outcome::complete : Outcome::no_equilibrium;
}

}  // namespace talus
