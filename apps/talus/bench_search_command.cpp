#include "commands.hpp"
#include "progress.hpp"
#include "scenario_files.hpp"
#include "search_table.hpp"

#include "core/errors.hpp"
#include "output/output_path.hpp"
#include "scenario/reader.hpp"
#include "simulation/record_boxes.hpp"
#include "simulation/search_bench.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>

namespace talus::cli {
namespace {

const char* const default_scenarios = "scenarios/benchmark";

std::string stem(const std::string& path) { return std::filesystem::path(path).stem().string(); }

/// What does not fit is said before anything runs.
SearchBench bench_of(const BenchSearchArguments& arguments) {
    SearchBench bench;
    bench.methods = arguments.methods.empty() ? bench_methods() : arguments.methods;
    if (bench.methods == std::vector<std::string>{"none"}) bench.methods.clear();
    bench.threads = arguments.threads;
    bench.skins = arguments.skins;
    bench.repeat = arguments.repeat;
    bench.check = arguments.no_check ? Check::none : arguments.check_direct ? Check::direct : Check::affordable;
    check_bench(bench);
    return bench;
}

Trajectory record(const Scenario& scenario, const std::string& scene, const BenchSearchArguments& arguments) {
    StatusLine line;
    Trajectory trajectory = record_boxes(scenario, {arguments.steps, arguments.every, arguments.from, arguments.axes_deg},
                                         [&](const std::string& now) { line.show(scene + ": " + now); });
    line.clear();
    return trajectory;
}

}  // namespace

int bench_search_command(const BenchSearchArguments& arguments) {
    std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is for the writer to find out, not a reason to die
    const SearchBench bench = bench_of(arguments);
    std::vector<std::string> files = arguments.scenarios;
    if (files.empty() && arguments.trajectories.empty()) files = scenario_files(default_scenarios);
    if (!arguments.record.empty() && files.size() != 1) throw InputError("--record keeps one motion: name one scenario");
    for (const std::string& path : arguments.trajectories) read_trajectory_size(path);
    std::vector<Scenario> scenarios;
    for (const std::string& file : files) scenarios.push_back(read_scenario(file, arguments.overrides));
    const auto output = [&](const std::string& path) {
        return path.empty() ? path : choose_output_path(path, arguments.force);
    };
    const std::string record_to = output(arguments.record), csv = output(arguments.csv);

    std::vector<SearchTable> all;
    const auto take = [&](const std::string& scene, const Trajectory& trajectory) {
        if (!bench.methods.empty())
            all.push_back(time_and_print(
                scene, trajectory,
                arguments.methods.empty() ? within_reach(bench, trajectory.boxes, largest_by_default) : bench));
    };
    for (std::size_t i = 0; i < scenarios.size(); ++i) {
        const Trajectory trajectory = record(scenarios[i], stem(files[i]), arguments);
        if (!record_to.empty()) {
            write_trajectory(record_to, trajectory);
            std::printf("%zu boxes, %zu steps in %s\n", trajectory.boxes, trajectory.steps(), record_to.c_str());
        }
        take(stem(files[i]), trajectory);
    }
    for (const std::string& path : arguments.trajectories) take(stem(path), read_trajectory(path));
    if (csv.empty()) return ok;
    write_search_tables(csv, all);
    std::printf("%s\n", csv.c_str());
    return ok;
}

}  // namespace talus::cli
