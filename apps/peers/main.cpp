// Contact searches of Talus and of other libraries on the same recorded motion, in one process, in turn.
#include "peers.hpp"
#include "search_table.hpp"

#include "core/errors.hpp"
#include "output/output_path.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <limits>

using namespace talus;

namespace {

struct Library {
    const char* name;
    std::unique_ptr<PairSearch> (*make)();
    std::size_t largest = std::numeric_limits<std::size_t>::max();  // boxes; more take minutes to build
};

constexpr std::array libraries = {
    Library{"box2d", peers::make_box2d},
    Library{"box2d-wide", peers::make_box2d_wide},
    Library{"bullet-tree", peers::make_bullet_tree, 200'000},
    Library{"bullet-tree-wide", peers::make_bullet_tree_wide, 200'000},
    Library{"bullet-axes", peers::make_bullet_axes, 20'000},
    Library{"cgal", peers::make_cgal},
    Library{"boost-rtree", peers::make_boost_rtree},
    Library{"fcl", peers::make_fcl},
};

std::unique_ptr<PairSearch> make(const std::string& name) {
    for (const Library& library : libraries)
        if (name == library.name) return library.make();
    const std::vector<std::string> ours = bench_methods();
    if (std::find(ours.begin(), ours.end(), name) != ours.end()) return make_search_or_bound(name);
    std::string message = "unknown search \"" + name + "\"; allowed:";
    for (const std::string& each : ours) message += " " + each;
    for (const Library& library : libraries) message += std::string(" ") + library.name;
    throw InputError(message);
}

std::size_t largest(const std::string& name) {
    for (const Library& library : libraries)
        if (name == library.name) return library.largest;
    return largest_by_default(name);
}

/// Throws InputError if some box is absent in some step: the libraries know nothing like that.
Trajectory complete_trajectory(const std::string& path) {
    Trajectory trajectory = read_trajectory(path);
    if (!std::all_of(trajectory.all.begin(), trajectory.all.end(), [](const Box& box) { return present(box); }))
        throw InputError(path + ": boxes are deleted on the way, which the other libraries cannot take");
    return trajectory;
}

int program(int argc, char** argv) {
    CLI::App app{"contact searches of Talus and of other libraries, side by side", "talus_bench_peers"};
    SearchBench bench;
    bench.make = make;
    std::vector<std::string> files;
    std::string csv;
    bool no_check = false, force = false;
    app.add_option("trajectories", files, "files as talus bench search --record writes them")->required();
    app.add_option("--methods", bench.methods, "names with commas between; default: all")->delimiter(',');
    app.add_option("--repeat", bench.repeat, "of each step the fastest counts; default 5");
    app.add_flag("--no-check", no_check, "do not compare the pairs of every step");
    app.add_option("-o,--output", csv, "CSV file");
    app.add_flag("--force", force, "replace an existing file instead of choosing a numbered name");
    CLI11_PARSE(app, argc, argv);

    const bool all = bench.methods.empty();
    if (all) bench.methods = bench_methods();
    if (all)
        for (const Library& library : libraries) bench.methods.emplace_back(library.name);
    if (no_check) bench.check = Check::none;
    check_bench(bench);
    for (const std::string& file : files) read_trajectory_size(file);
    if (!csv.empty()) csv = choose_output_path(csv, force);
    std::vector<cli::SearchTable> tables;
    for (const std::string& file : files) {
        const Trajectory trajectory = complete_trajectory(file);
        tables.push_back(cli::time_and_print(std::filesystem::path(file).stem().string(), trajectory,
                                             all ? cli::within_reach(bench, trajectory.boxes, largest) : bench));
    }
    if (!csv.empty()) cli::write_search_tables(csv, tables);
    const auto right = [](const SearchCost& cost) { return cost.wrong_steps.value_or(0) == 0; };
    const auto all_right = [&](const cli::SearchTable& t) { return std::all_of(t.costs.begin(), t.costs.end(), right); };
    return std::all_of(tables.begin(), tables.end(), all_right) ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return program(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 2;
    }
}
