#include "commands.hpp"
#include "progress.hpp"

#include "output/output_path.hpp"
#include "output/whole_file.hpp"
#include "scenario/reader.hpp"
#include "simulation/step_bench.hpp"

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string_view>

namespace talus::cli {
namespace {

struct Measured {
    std::string scene;
    StepCosts costs;
};

void print(const Measured& m) {
    std::printf("%s: %d blocks, %d convex parts, %lld contacts; built in %.3g s, %.4g bytes per block\n", m.scene.c_str(),
                m.costs.blocks, m.costs.parts, static_cast<long long>(m.costs.contacts), m.costs.build_s,
                m.costs.bytes_per_block);
    std::printf("  ns per block and step\n  %7s %9s", "threads", "all");
    for (const char* part : part_names) std::printf(" %9s", part);
    std::printf(" %9s\n", "lists");
    for (const StepCost& cost : m.costs.threads) {
        std::printf("  %7d %9.4g", cost.threads, cost.all);
        for (const double part : cost.parts) std::printf(" %9.4g", part);
        std::printf(" %9lld\n", static_cast<long long>(cost.refreshes));
    }
    std::fflush(stdout);
}

void write_csv(const std::string& path, const std::vector<Measured>& all, int steps) {
    write_whole_file(path, [&](std::ostream& file) {
        file << "scene,blocks,parts,contacts,threads,steps,ns_per_block_and_step";
        for (const std::string_view part : part_names) file << ',' << part << (part == "contacts" ? "_part" : "");
        file << ",refreshes,bytes_per_block,build_s\n";
        for (const Measured& m : all)
            for (const StepCost& cost : m.costs.threads) {
                file << m.scene << ',' << m.costs.blocks << ',' << m.costs.parts << ',' << m.costs.contacts << ','
                     << cost.threads << ',' << steps << ',' << cost.all;
                for (const double part : cost.parts) file << ',' << part;
                file << ',' << cost.refreshes << ',' << m.costs.bytes_per_block << ',' << m.costs.build_s << '\n';
            }
    });
}

}  // namespace

int bench_step_command(const BenchStepArguments& arguments) {
    std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is for the writer to find out, not a reason to die
    std::vector<Scenario> scenarios;
    for (const std::string& file : arguments.scenarios) scenarios.push_back(read_scenario(file, arguments.overrides));
    const std::string csv = arguments.csv.empty() ? "" : choose_output_path(arguments.csv, arguments.force);
    std::vector<Measured> all;
    for (std::size_t i = 0; i < scenarios.size(); ++i) {
        const std::string scene = std::filesystem::path(arguments.scenarios[i]).stem().string();
        StatusLine line;
        all.push_back(
            {scene, time_steps(scenarios[i], {arguments.threads, arguments.steps, arguments.repeat, arguments.from},
                               [&](const std::string& now) { line.show(scene + ": " + now); })});
        line.clear();
        print(all.back());
    }
    if (csv.empty()) return ok;
    write_csv(csv, all, arguments.steps * arguments.repeat);
    std::printf("%s\n", csv.c_str());
    return ok;
}

}  // namespace talus::cli
