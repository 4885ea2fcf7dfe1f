#include "commands.hpp"
#include "summary.hpp"

#include "output/output_path.hpp"
#include "output/results.hpp"
#include "scenario/reader.hpp"
#include "simulation/preview.hpp"
#include "simulation/run.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>

namespace talus::cli {
namespace {

constexpr int trial_steps = 20;  // run to measure the cost of one

void print_blocks(const Simulation& simulation) {
    const Model& model = simulation.model();
    std::vector<double> area = model.blocks.area;
    std::sort(area.begin(), area.end());
    const auto quantile = [&](double q) { return area[static_cast<std::size_t>(q * static_cast<double>(area.size() - 1))]; };
    int held = 0, concave = 0;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        held += model.blocks.held(b);
        concave += model.blocks.first_part[b + 1] - model.blocks.first_part[b] > 1;
    }
    std::printf("blocks         %d, of them %d held, %d concave (%d convex parts in all)\n", model.blocks.size(), held,
                concave, model.parts.size());
    std::printf("  by size      area %s smallest, %s median, %s largest; sum %s\n", number(area.front(), "m2").c_str(),
                number(quantile(0.5), "m2").c_str(), number(area.back(), "m2").c_str(),
                number(std::accumulate(area.begin(), area.end(), 0.0), "m2").c_str());
    for (double upper = std::pow(10.0, std::floor(std::log10(area.front())) + 1.0);; upper *= 10.0) {
        const auto n =
            std::upper_bound(area.begin(), area.end(), upper) - std::upper_bound(area.begin(), area.end(), upper / 10);
        if (n > 0) std::printf("               %8td of %.0e to %.0e m2\n", n, upper / 10, upper);
        if (upper >= area.back()) break;
    }
    std::printf("  shortest edge %s, thinnest part %s\n",
                number(*std::min_element(model.corners.length.begin(), model.corners.length.end()), "m").c_str(),
                number(*std::min_element(model.parts.thickness.begin(), model.parts.thickness.end()), "m").c_str());
}

void print_cut(const BuildReport& report) {
    const CutReport& cut = report.cut;
    if (cut.outline_area <= 0.0) return;
    std::printf("cut            area of the outline less holes %.12g m2, sum of blocks differs by %.1g of it\n",
                cut.outline_area, std::abs(cut.blocks_area - cut.outline_area) / cut.outline_area);
    std::printf("               %d dangling ends pruned, %d slivers merged (%s), %d dropped, %d concave, %d islands\n",
                cut.dangling, cut.merged, number(cut.merged_area, "m2").c_str(), cut.dropped, cut.concave, cut.islands);
    for (std::size_t i = 0; i < std::min<std::size_t>(cut.merged_at.size(), 5); ++i)
        std::printf("               sliver at (%.6g, %.6g)\n", cut.merged_at[i].x(), cut.merged_at[i].y());
    if (report.trace_count > 0)
        std::printf("traces         %d read, %d tips extended\n", report.trace_count, report.tips_extended);
}

void print_joints(const Simulation& simulation) {
    const Model& model = simulation.model();
    std::printf("joints         each touching pair of parts got:\n");
    for (std::size_t j = 0; j < model.joints.size(); ++j)
        std::printf("  %-12s %d pairs\n", model.joints[j].name.c_str(),
                    j < simulation.report().faces_per_joint.size() ? simulation.report().faces_per_joint[j] : 0);
    if (!model.faces.empty()) std::printf("  %zu of the faces are bonded or under initial stress\n", model.faces.size());
}

// Closure of the joints under the weight above, against the size of a block: more than 1e-3 and the stiffness shows.
void print_settlement(const Simulation& simulation) {
    const Model& model = simulation.model();
    const double g = std::hypot(model.gravity_x(0.0), model.gravity_y(0.0));
    if (g == 0.0 || model.blocks.size() == 0) return;
    double low = 1e300, high = -1e300, mass = 0.0, area = 0.0, softest = 1e300;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        low = std::min(low, model.blocks.start[b].y() - model.blocks.radius[b]);
        high = std::max(high, model.blocks.start[b].y() + model.blocks.radius[b]);
        mass += model.blocks.mass[b];
        area += model.blocks.area[b];
    }
    for (const Joint& joint : model.joints) softest = std::min(softest, joint.kn);
    const double closure = mass / area * g * (high - low) / softest;
    const double size = std::sqrt(area / model.blocks.size());
    std::printf("settlement     the softest joint closes by %s under the whole height: %.1g of a mean block (%s)%s\n",
                number(closure, "m").c_str(), closure / size, number(size, "m").c_str(),
                closure > 1e-2 * size ? "; stiffer joints would be nearer to rock" : "");
}

double peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

void print_cost(Simulation& simulation) {
    const StableStep stable = simulation.stable();
    const Model& model = simulation.model();
    const double dt = simulation.state().stage_step;
    const int stages = simulation.stage_count();
    std::printf("time step      %s: rigorous bound %s, limit estimated at %s\n", number(dt, "s").c_str(),
                number(stable.bound, "s").c_str(), number(stable.estimate, "s").c_str());
    if (stable.block >= 0) {
        const Vec2 at = model.blocks.start[stable.block] + model.origin;
        std::printf("               governed by block %d, %s, at (%.6g, %.6g)\n", stable.block,
                    number(model.blocks.area[stable.block], "m2").c_str(), at.x(), at.y());
    }
    Stopwatch clock;
    for (int i = 0; i < trial_steps && !simulation.stage_over(); ++i) simulation.step();
    const double per_step = clock.seconds() / std::max<double>(static_cast<double>(simulation.steps_done()), 1.0);
    double length = 0.0;
    bool open_end = false;
    const Scenario& scenario = simulation.scenario();
    std::vector<Until> untils;
    for (const StageSpec& stage : scenario.stages) untils.push_back(stage.until);
    untils.push_back(scenario.run.until);
    for (const Until& until : untils) {
        length += until.time.value_or(0.0);
        open_end = open_end || until.equilibrium;
    }
    std::printf("cost           %d stage%s, %s%.3g steps, %s per step, %s%s in all\n", stages, stages == 1 ? "" : "s",
                open_end ? "at most " : "", length / dt, number(1e3 * per_step, "ms").c_str(),
                open_end ? "at most " : "about ", number(length / dt * per_step, "s").c_str());
    const double frames = scenario.record.frame_every && simulation.recorded_time() > 0.0
                              ? simulation.recorded_time() / *scenario.record.frame_every
                              : scenario.record.frame_count.value_or(50);
    const double bytes =
        60.0 * model.blocks.size() + 12.0 * model.corners.size() +
        (scenario.record.contacts ? 100.0 * static_cast<double>(simulation.state().contacts.list.size()) / 2 : 0.0);
    std::printf("memory         %s now; results about %s for %.0f frames\n", number(peak_memory() / 1e6, "MB").c_str(),
                number(frames * bytes / 1e6, "MB").c_str(), frames);
}

void write_geometry(const std::string& path, Simulation& simulation) {
    Recorder recorder(path, simulation, std::vector<std::string>{});
    recorder.write_frame(simulation, with_all_touching_faces(simulation));
    recorder.close("checked");
}

}  // namespace

int check_command(const CheckArguments& arguments) {
    if (arguments.schema) {
        std::printf("%s", scenario_schema().c_str());
        return ok;
    }
    if (arguments.scenario.empty()) throw InputError("check needs a scenario file");
    const Scenario scenario = read_scenario(arguments.scenario, arguments.overrides);
    read_cases(arguments.scenario, arguments.overrides);
    if (arguments.resolved) {
        std::printf("%s\n", scenario.canonical_json.c_str());
        return ok;
    }
    Simulation simulation(scenario, build(scenario));
    simulation.begin_stage();
    check_probes(simulation);
    std::printf("%s\n", scenario.title.c_str());
    if (!arguments.geometry.empty()) {
        const std::string path = choose_output_path(arguments.geometry, arguments.force);
        write_geometry(path, simulation);
        std::printf("geometry       %s\n", path.c_str());
    }
    print_blocks(simulation);
    print_cut(simulation.report());
    print_joints(simulation);
    print_settlement(simulation);
    std::printf("solver         explicit: the only one yet; right where joint stiffness is given\n");
    print_cost(simulation);
    for (const std::string& warning : simulation.report().warnings) std::printf("warning: %s\n", warning.c_str());
    return ok;
}

}  // namespace talus::cli
