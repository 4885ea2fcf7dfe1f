#include "commands.hpp"
#include "progress.hpp"
#include "scenario_files.hpp"

#include "core/errors.hpp"
#include "output/output_path.hpp"
#include "output/whole_file.hpp"
#include "scenario/reader.hpp"
#include "simulation/record_boxes.hpp"
#include "simulation/search_bench.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <sstream>

namespace talus::cli {
namespace {

const char* const default_scenarios = "scenarios/benchmark";

struct Measured {
    std::string scene;
    std::size_t boxes, steps;
    std::vector<SearchCost> costs;
};

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

/// Without those that would take hours, unless they were asked for.
SearchBench for_size(SearchBench bench, std::size_t boxes, bool asked_for) {
    if (asked_for) return bench;
    std::string left_out;
    std::erase_if(bench.methods, [&](const std::string& method) {
        if (boxes <= largest_by_default(method)) return false;
        left_out += (left_out.empty() ? "" : ", ") + method;
        return true;
    });
    if (!left_out.empty())
        std::printf("  left out, too slow for %zu boxes: %s (name them in --methods to have them)\n", boxes,
                    left_out.c_str());
    return bench;
}

void print(const SearchCost& c) {
    const std::string wrong = c.wrong_steps ? std::to_string(*c.wrong_steps) : "-";
    std::printf("  %-16s %3d %7.4g %9.3g %9.3g %9.3g %9.3g %9.3g %9.3g %9.3g %8.3g %7.3g %7.0f %6s%s%s\n", c.method.c_str(),
                c.threads, c.skin, c.median, c.q1, c.q3, c.mean, c.max, c.first, c.list, c.exchanges, c.pairs, c.bytes,
                wrong.c_str(), c.choice.empty() ? "" : "  ", c.choice.c_str());
}

Measured measure(const std::string& scene, const Trajectory& trajectory, const SearchBench& bench, bool asked_for) {
    std::printf("%s: %zu boxes, %zu steps\n", scene.c_str(), trajectory.boxes, trajectory.steps());
    const SearchBench fitting = for_size(bench, trajectory.boxes, asked_for);
    StatusLine line;
    Measured measured{scene, trajectory.boxes, trajectory.steps(),
                      time_searches(trajectory, fitting, [&](const std::string& now) { line.show(scene + ": " + now); })};
    line.clear();
    std::printf("  ns per box and step\n  %-16s %3s %7s %9s %9s %9s %9s %9s %9s %9s %8s %7s %7s %6s\n", "method", "thr",
                "skin", "median", "q1", "q3", "mean", "max", "first", "list", "exch", "pairs", "bytes", "wrong");
    for (const SearchCost& cost : measured.costs) print(cost);
    std::fflush(stdout);
    return measured;
}

void write_csv(const std::string& path, const std::vector<Measured>& all) {
    write_whole_file(path, [&](std::ostream& file) {
        file
            << "scene,boxes,steps,method,threads,skin,ns_per_box_median,ns_per_box_q1,ns_per_box_q3,ns_per_box_mean,"
               "ns_per_box_max,first_ns_per_box,list_ns_per_box,exchanges_per_box,pairs_per_box,bytes_per_box,wrong_steps\n";
        for (const Measured& m : all)
            for (const SearchCost& c : m.costs) {
                file << m.scene << ',' << m.boxes << ',' << m.steps << ',' << c.method << ',' << c.threads << ',' << c.skin;
                for (const double x : {c.median, c.q1, c.q3, c.mean, c.max, c.first, c.list, c.exchanges, c.pairs, c.bytes})
                    file << ',' << x;
                file << ',';
                if (c.wrong_steps) file << *c.wrong_steps;
                file << '\n';
            }
    });
}

Trajectory record(const Scenario& scenario, const std::string& scene, const BenchSearchArguments& arguments) {
    StatusLine line;
    Trajectory trajectory = record_boxes(scenario, {arguments.steps, arguments.every, arguments.from},
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

    std::vector<Measured> all;
    const auto take = [&](const std::string& scene, const Trajectory& trajectory) {
        if (!bench.methods.empty()) all.push_back(measure(scene, trajectory, bench, !arguments.methods.empty()));
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
    write_csv(csv, all);
    std::printf("%s\n", csv.c_str());
    return ok;
}

}  // namespace talus::cli
