#include "commands.hpp"

#include "core/errors.hpp"
#include "core/version.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <functional>
#include <new>

using namespace talus;
using namespace talus::cli;

namespace {

// Options that are only a shorter way to write --set.
void add_overrides(CLI::App& command, std::vector<std::string>& overrides) {
    command.add_option("--set", overrides, "PATH=VALUE: change any key, e.g. joints.bedding.friction_angle_deg=25")
        ->allow_extra_args(false);
    const auto shorthand = [&](const char* option, const char* key, const char* help) {
        command.add_option_function<std::string>(
            option, [&overrides, key](const std::string& value) { overrides.push_back(std::string(key) + "=" + value); },
            help);
    };
    shorthand("--solver", "run.solver", "auto, explicit, rigid or static");
    shorthand("--search", "run.search", "how neighbours are found; never changes a result");
    shorthand("--threads", "run.threads", "never changes a result");
    shorthand("--until", "run.until.time", "s, length of the run");
}

void add_bench_search(CLI::App& bench_app, BenchSearchArguments& search, std::function<int()>& command) {
    CLI::App* search_app = bench_app.add_subcommand("search", "contact searches timed and checked on recorded motion");
    search_app->add_option("scenarios", search.scenarios,
                           "scenarios to run and record; default: those of scenarios/benchmark");
    search_app->add_option("--trajectory", search.trajectories, "recorded motion (BPTRAJ01), instead of a scenario")
        ->allow_extra_args(false);
    search_app->add_option("--record", search.record, "keep what was recorded in this file");
    search_app->add_option("--steps", search.steps, "steps to record; default 200");
    search_app->add_option("--every", search.every, "time steps of the run from one recorded step to the next; default 1");
    search_app->add_option("--from", search.from,
                           "record from this time (s, as results count it) or stage; default the last stage");
    search_app->add_option("--axes", search.axes_deg,
                           "degrees from x and y along which boxes are taken; default as in a run: turned away from joints");
    search_app
        ->add_option("--methods", search.methods, "names with commas; `read`: the bound; none: record only; default all")
        ->delimiter(',');
    search_app->add_option("--threads", search.threads, "numbers with commas; default 1")->delimiter(',');
    search_app->add_option("--skin", search.skins, "m, numbers with commas; default 0")->delimiter(',');
    search_app->add_option("--repeat", search.repeat, "of each step the fastest of so many counts; default 5");
    search_app->add_flag("--no-check", search.no_check, "do not compare the pairs with a reference");
    search_app->add_flag("--check-direct", search.check_direct, "compare with `direct` at every step, whatever it takes");
    search_app->add_option("-o,--output", search.csv, "table as CSV");
    search_app->add_flag("--force", search.force, "replace existing files instead of choosing a numbered name");
    search_app->add_option("--set", search.overrides, "PATH=VALUE: change any key of the scenarios")
        ->allow_extra_args(false);
    search_app->callback([&] { command = [&] { return bench_search_command(search); }; });
}

void add_bench_step(CLI::App& bench_app, BenchStepArguments& step, std::function<int()>& command) {
    CLI::App* step_app = bench_app.add_subcommand("step", "time per block and step by its parts, and memory");
    step_app->add_option("scenarios", step.scenarios, "scenario files (YAML)")->required();
    step_app->add_option("--threads", step.threads, "numbers with commas; default 1")->delimiter(',');
    step_app->add_option("--steps", step.steps, "steps in a segment; default 200");
    step_app->add_option("--repeat", step.repeat, "segments for each number of threads; default 5");
    step_app->add_option("--from", step.from,
                         "time from this time (s, as results count it) or stage; default the last stage");
    step_app->add_option("-o,--output", step.csv, "table as CSV");
    step_app->add_flag("--force", step.force, "replace an existing file instead of choosing a numbered name");
    step_app->add_option("--set", step.overrides, "PATH=VALUE: change any key of the scenarios")->allow_extra_args(false);
    step_app->callback([&] { command = [&] { return bench_step_command(step); }; });
}

int program(int argc, char** argv) {
    CLI::App app{"2D discrete-element simulator for jointed rock and masonry", "talus"};
    app.set_version_flag("--version", std::string("talus ") + version);
    app.require_subcommand(1);
    std::function<int()> command;

    RunArguments run;
    CLI::App* run_app = app.add_subcommand("run", "run a scenario and write its results");
    run_app->add_option("scenario", run.scenario, "scenario file (YAML)")->required();
    run_app->add_option("-o,--output", run.output, "result file; default: the name of the scenario with .h5, here");
    run_app->add_option("--case", run.case_name, "run this row of `cases`");
    run_app->add_flag("--force", run.force, "replace an existing result instead of choosing a numbered name");
    run_app->add_flag("--estimate-error", run.estimate_error,
                      "run again with shorter steps, and tell what the results may be wrong by");
    add_overrides(*run_app, run.overrides);
    run_app->callback([&] { command = [&] { return run_command(run); }; });

    CheckArguments check;
    CLI::App* check_app = app.add_subcommand("check", "what is known before a run: faults, blocks, joints, step, cost");
    check_app->add_option("scenario", check.scenario, "scenario file (YAML)");
    check_app->add_flag("--resolved", check.resolved,
                        "print the scenario with every default as canonical JSON, nothing else");
    check_app->add_option("--geometry", check.geometry, "write the blocks as a result file with one frame, for a picture");
    check_app->add_flag("--force", check.force, "replace an existing file instead of choosing a numbered name");
    check_app->add_flag("--schema", check.schema, "print the JSON Schema of scenario files, for editors");
    add_overrides(*check_app, check.overrides);
    check_app->callback([&] { command = [&] { return check_command(check); }; });

    std::string scenario;
    CLI::App* resolve_app = app.add_subcommand(
        "resolve", "the hash of each of many variants: lists of PATH=VALUE from standard input, one in a line");
    resolve_app->add_option("scenario", scenario, "scenario file (YAML)")->required();
    resolve_app->callback([&] { command = [&] { return resolve_command(scenario); }; });

    std::string results, folder = ".";
    int threads = 0;
    CLI::App* resume_app = app.add_subcommand("resume", "go on with a run that was interrupted, bit for bit");
    resume_app->add_option("results", results, "result file, with its .restart.h5 beside it")->required();
    resume_app->add_option("--threads", threads, "default: as before");
    resume_app->callback([&] { command = [&] { return resume_command(results, threads); }; });

    CLI::App* info_app = app.add_subcommand("info", "what is in a result file");
    info_app->add_option("results", results)->required();
    info_app->callback([&] { command = [&] { return info_command(results); }; });

    QueryArguments query;
    CLI::App* query_app = app.add_subcommand("query", "which blocks of a result are at a place");
    query_app->add_option("results", query.results)->required();
    const auto question = [&](const char* option, std::vector<std::string>& places, const char* help) {
        query_app->add_option(option, places, help)->allow_extra_args(false);
    };
    question("--at", query.at, "X,Y: blocks that hold this point");
    question("--in", query.in, "X0,Y0,X1,Y1: blocks that meet this rectangle");
    question("--along", query.along, "X0,Y0,X1,Y1: blocks that this line enters, in their order");
    query_app->add_option("--frame", query.frame, "from 0; default: the last one");
    query_app->callback([&] { command = [&] { return query_command(query); }; });

    CLI::App* export_app = app.add_subcommand("export", "histories and energies as CSV");
    export_app->add_option("results", results)->required();
    export_app->add_option("-o,--output", folder, "folder");
    export_app->callback([&] { command = [&] { return export_command(results, folder); }; });

    VerifyArguments verify;
    verify.path = "scenarios/verification";
    CLI::App* verify_app = app.add_subcommand("verify", "run scenarios that say what they expect, and compare");
    verify_app->add_option("path", verify.path, "folder or file; default scenarios/verification");
    verify_app->add_option("--case", verify.filter, "only cases whose name contains this");
    verify_app->add_option("--csv", verify.csv, "table of all expectations: measured, bar, passed");
    verify_app->add_flag("--force", verify.force, "replace an existing table instead of choosing a numbered name");
    add_overrides(*verify_app, verify.overrides);
    verify_app->callback([&] { command = [&] { return verify_command(verify); }; });

    CLI::App* bench_app = app.add_subcommand("bench", "how long things take on this machine");
    bench_app->require_subcommand(1);
    BenchSearchArguments bench_search;
    add_bench_search(*bench_app, bench_search, command);
    BenchStepArguments bench_step;
    add_bench_step(*bench_app, bench_step, command);

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? ok : bad_input;
    }
    return command();
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return program(argc, argv);
    } catch (const InputError& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return bad_input;
    } catch (const DivergenceError& error) {
        std::fprintf(stderr, "diverged: %s\n", error.what());
        return diverged;
    } catch (const OutputError& error) {
        std::fprintf(stderr, "output failed: %s\n", error.what());
        return output_failed;
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "out of memory\n");
        return failed;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "a fault of talus itself: %s\n", error.what());
        return failed;
    }
}
