#include "commands.hpp"
#include "progress.hpp"
#include "summary.hpp"

#include "core/errors.hpp"
#include "output/output_path.hpp"
#include "output/reader.hpp"
#include "scenario/reader.hpp"
#include "simulation/run.hpp"
#include "simulation/trial.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>

namespace talus::cli {
namespace {

std::atomic<bool> asked_to_stop{false};

void ask_to_stop(int) { asked_to_stop = true; }

// Ctrl-C and a polite kill end the run at the next step, with a restart file. From the moment there is a result file: until
// then there is nothing to save. A file that may not grow is for the writer to find out, not a reason to die.
void listen_for_signals() {
    std::signal(SIGINT, ask_to_stop);
    std::signal(SIGTERM, ask_to_stop);
    std::signal(SIGXFSZ, SIG_IGN);
}

Scenario row_named(std::vector<Case> rows, const std::string& name, const std::string& file) {
    std::string names;
    for (Case& row : rows) {
        if (row.name == name) return std::move(row.scenario);
        names += (names.empty() ? "" : ", ") + row.name;
    }
    throw InputError(file + ": there is no case '" + name + "'; there are: " + names);
}

Scenario pick(const RunArguments& arguments) {
    if (arguments.case_name.empty()) return read_scenario(arguments.scenario, arguments.overrides);
    return row_named(read_cases(arguments.scenario, arguments.overrides), arguments.case_name, arguments.scenario);
}

// What was asked for on the command line, as it is noted in the files: the overrides, and the row of `cases`.
const std::string case_mark = "case: ";

std::vector<std::string> note(const RunArguments& arguments) {
    std::vector<std::string> notes = arguments.overrides;
    if (!arguments.case_name.empty()) notes.push_back(case_mark + arguments.case_name);
    return notes;
}

Scenario read_noted(const RestartInfo& info) {
    std::vector<std::string> overrides = info.overrides;
    const std::string folder = std::filesystem::path(info.scenario_file).parent_path().string();
    if (overrides.empty() || overrides.back().rfind(case_mark, 0) != 0)
        return read_scenario_text(info.scenario_text, info.scenario_file, folder, overrides);
    const std::string name = overrides.back().substr(case_mark.size());
    overrides.pop_back();
    return row_named(read_cases_text(info.scenario_text, info.scenario_file, folder, overrides), name, info.scenario_file);
}

// Without what compares it with other cases, and what is said of runs that end early.
std::vector<ExpectSpec> judged_alone(std::vector<ExpectSpec> expects) {
    std::erase_if(
        expects, [](const ExpectSpec& e) { return !e.same_as.empty() || (about_what_is_told(e) && !about_the_verdict(e)); });
    return expects;
}

// Why a restart file does not fit the scenario in it: a file that the scenario names is another one now, or else Talus is.
void check_still_the_same(const Scenario& scenario, const RestartInfo& info, const std::string& results) {
    if (scenario.hash == info.scenario_hash) return;
    const auto then = ResultsReader(results).files();
    for (std::size_t i = 0; i < std::min(then.size(), scenario.files.size()); ++i)
        if (then[i].second != scenario.files[i].second)
            throw InputError(scenario.files[i].first + ": has changed since " + results +
                             " was begun; a run goes on only with what it began with");
    throw InputError(restart_path(results) + ": the scenario in it reads differently with this version");
}

void print_scene(const Simulation& simulation) {
    const Model& model = simulation.model();
    const auto held = [&] {
        int n = 0;
        for (BlockId b = 0; b < model.blocks.size(); ++b) n += model.blocks.held(b);
        return n;
    }();
    std::printf("%s\n%d blocks (%d held), %d convex parts, solver %s, search %s, %d thread%s\n",
                simulation.scenario().title.c_str(), model.blocks.size(), held, model.parts.size(),
                simulation.stage().solver.c_str(), simulation.scenario().run.search.c_str(),
                simulation.scenario().run.threads, simulation.scenario().run.threads == 1 ? "" : "s");
    for (const std::string& warning : simulation.report().warnings) std::printf("warning: %s\n", warning.c_str());
}

// Runs what is set up and closes the files, however it ends. What was written stays readable in every case.
// `watch`: of so many expectations and, after them, of what the error is to be estimated.
int carry_out(Simulation& simulation, Recorder& recorder, Watch* watch, std::size_t expectations, Entry entry) {
    Progress progress;
    Stopwatch clock;
    RunOptions options;
    options.recorder = &recorder;
    options.watch = watch;
    options.entry = entry;
    std::vector<double> steps;  // s, of each stage
    options.stage_begun = [&](const Simulation& s) {
        steps.push_back(s.state().stage_step);
        progress.stage_begun(s);
        print_stage(s);
        if (const std::string warning = long_stage(s); !warning.empty()) std::printf("warning: %s\n", warning.c_str());
        std::fflush(stdout);
    };
    options.progress = [&](const Simulation& s) { progress(s); };
    options.interrupted = [] { return asked_to_stop.load(); };
    if (entry == Entry::resumed) progress.stage_begun(simulation);

    Outcome outcome = Outcome::complete;
    try {
        outcome = run(simulation, options);
    } catch (const DivergenceError&) {
        progress.done();
        recorder.finish(simulation, "diverged", clock.seconds());
        std::printf("results up to the last good frame: %s\n", recorder.path().c_str());
        throw;
    } catch (const InputError&) {
        progress.done();
        recorder.finish(simulation, "refused", clock.seconds());
        std::printf("stage %s cannot begin; results up to its start: %s\n", simulation.stage().name.c_str(),
                    recorder.path().c_str());
        throw;
    } catch (const OutputError&) {
        progress.done();
        std::printf("results up to the last complete frame: %s\n", recorder.path().c_str());
        throw;
    }
    progress.done();
    const char* status = outcome == Outcome::complete      ? "complete"
                         : outcome == Outcome::interrupted ? "interrupted"
                                                           : "stopped";
    recorder.finish(simulation, status, clock.seconds());
    print_summary(simulation, clock.seconds());
    std::printf("%lld frames in %s\n", static_cast<long long>(recorder.frames()), recorder.path().c_str());
    if (outcome == Outcome::interrupted) {
        std::printf("interrupted at t = %s; go on with: talus resume %s\n", number(simulation.state().time, "s").c_str(),
                    recorder.path().c_str());
        return interrupted;
    }
    int failed = 0;
    if (watch) {
        const std::vector<Verdict> verdicts = watch->judge({.fault = {}, .warnings = {}, .verdict = simulation.verdict()});
        const auto end = verdicts.begin() + static_cast<std::ptrdiff_t>(expectations);
        failed = print_verdicts({verdicts.begin(), end}, "  ");
        if (end != verdicts.end())
            print_error_estimate(estimate_error(simulation, steps, {end, verdicts.end()}),
                                 simulation.scenario().run.accuracy);
    }
    for (const Unsettled& stage : simulation.state().unsettled) std::printf("%s\n", out_of_time(simulation, stage).c_str());
    return failed > 0 || outcome == Outcome::no_equilibrium ? not_met : ok;
}

std::string default_output(const std::string& scenario) { return std::filesystem::path(scenario).stem().string() + ".h5"; }

}  // namespace

int run_command(const RunArguments& arguments) {
    const Scenario scenario = pick(arguments);
    listen_for_signals();  // before any file can be seen: who waits for one may interrupt at once
    const std::string output = choose_output_path(
        arguments.output.empty() ? default_output(arguments.scenario) : arguments.output, arguments.force);
    Simulation simulation(scenario, build(scenario));
    print_scene(simulation);
    simulation.begin_stage();  // before any file is touched: the time step may be refused
    check_probes(simulation);
    Recorder recorder(output, simulation, note(arguments));
    std::unique_ptr<Watch> watch;
    std::vector<ExpectSpec> watched = judged_alone(scenario.expect);
    const std::size_t expectations = watched.size();
    if (arguments.estimate_error)
        for (ExpectSpec& expect : watched_for_error(scenario)) watched.push_back(std::move(expect));
    if (!watched.empty()) watch = std::make_unique<Watch>(watched, simulation.model(), simulation.first_state());
    return carry_out(simulation, recorder, watch.get(), expectations, Entry::begun);
}

int resume_command(const std::string& results, int threads) {
    if (!std::filesystem::exists(restart_path(results)))
        throw InputError(restart_path(results) + ": is not there; a run goes on from this file, which it left beside its " +
                         "results: bring it back, or run the scenario again");
    const RestartInfo info = read_restart_info(restart_path(results));
    Scenario scenario = read_noted(info);
    check_still_the_same(scenario, info, results);
    if (threads > 0) scenario.run.threads = threads;
    Scene scene = build(scenario);
    State state = read_restart(restart_path(results), scene.model);
    Simulation simulation(scenario, std::move(scene), std::move(state));
    print_scene(simulation);
    listen_for_signals();
    Recorder recorder(results, simulation, info);
    std::printf("going on from t = %s, frame %lld\n", number(simulation.state().time, "s").c_str(),
                static_cast<long long>(recorder.frames()));
    if (!scenario.expect.empty()) std::printf("note: expectations need the whole run and are not judged after a resume\n");
    return carry_out(simulation, recorder, nullptr, 0, Entry::resumed);
}

}  // namespace talus::cli
