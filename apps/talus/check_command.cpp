#include "commands.hpp"
#include "cost.hpp"
#include "summary.hpp"

#include "core/memory.hpp"
#include "core/text.hpp"
#include "model/title.hpp"
#include "output/output_path.hpp"
#include "output/results.hpp"
#include "scenario/reader.hpp"
#include "simulation/preview.hpp"
#include "simulation/run.hpp"
#include "simulation/trial.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>

namespace talus::cli {
namespace {

constexpr std::size_t slivers_shown = 5;

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
    std::printf("               shortest edge %s, thinnest part %s\n",
                number(*std::min_element(model.corners.length.begin(), model.corners.length.end()), "m").c_str(),
                number(*std::min_element(model.parts.thickness.begin(), model.parts.thickness.end()), "m").c_str());
}

void print_traces(const Simulation& simulation) {
    const BuildReport& report = simulation.report();
    if (!simulation.scenario().rock || !simulation.scenario().rock->traces) return;
    const TraceMapSpec& map = *simulation.scenario().rock->traces;
    std::printf("traces         %d read from %s; %d of %d ends are free and were extended by %s\n", report.trace_count,
                std::filesystem::path(map.file).filename().c_str(), report.tips_extended, 2 * report.trace_count,
                number(map.extend, "m").c_str());
    std::printf("               snapped within %s: %d corners moved onto another one, %d set into traces that pass by\n",
                number(map.snap, "m").c_str(), report.corners_snapped, report.trace_junctions);
}

void print_slivers(const CutReport& cut, const Vec2& origin) {
    std::printf("slivers        smaller than %s or narrower than %s: ", number(cut.sliver_area, "m2").c_str(),
                number(cut.sliver_width, "m").c_str());
    if (cut.merged + cut.dropped == 0) {
        std::printf("none\n");
        return;
    }
    std::printf("%d merged with a neighbour (%s), %d dropped (%s)\n", cut.merged, number(cut.merged_area, "m2").c_str(),
                cut.dropped, number(cut.dropped_area, "m2").c_str());
    const std::size_t shown = std::min(cut.merged_at.size(), slivers_shown);
    for (std::size_t i = 0; i < shown; ++i)
        std::printf("%s%s", i == 0 ? "               at " : ", ",
                    place(cut.merged_at[i] + origin, cut.sliver_width).c_str());
    if (shown > 0) std::printf("%s\n", shown < cut.merged_at.size() ? ", ..." : "");
}

void print_cut(const Simulation& simulation) {
    const CutReport& cut = simulation.report().cut;
    if (cut.outline_area <= 0.0) return;
    print_traces(simulation);
    std::printf("cut            %d ends of lines stop inside a block and cut nothing (pruned), %d islands\n", cut.dangling,
                cut.islands);
    std::printf("               outline less holes %.10g m2; sum of the blocks differs by %.1g of it\n", cut.outline_area,
                std::abs(cut.blocks_area - cut.outline_area) / cut.outline_area);
    print_slivers(cut, simulation.model().origin);
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

void print_decisions(const Simulation& simulation) {
    const std::optional<AccuracySpec>& accuracy = simulation.scenario().run.accuracy;
    if (!accuracy) return;
    std::printf("accuracy       %s; what it decides:\n", in_words(*accuracy).c_str());
    for (const Decision& c : simulation.decisions().choices)
        std::printf("  %-12s %s: %s\n", c.what.c_str(), c.value.c_str(), c.why.c_str());
}

void print_step(const Simulation& simulation) {
    if (simulation.timeless()) return;
    const StableStep stable = simulation.stable();
    std::printf("time step      %s", number(simulation.state().stage_step, "s").c_str());
    if (simulation.stage().solver == "explicit") {
        std::printf(": rigorous bound %s, limit estimated at %s\n", number(stable.bound, "s").c_str(),
                    number(stable.estimate, "s").c_str());
        if (stable.block >= 0)
            std::printf("               governed by %s, %s\n", title_and_place(simulation.model(), stable.block).c_str(),
                        number(simulation.model().blocks.area[stable.block], "m2").c_str());
        const std::string substeps = substeps_in_words(simulation);
        const double gain = simulation.scenario().run.substeps == 1 ? simulation.gain_of_substeps() : 1.0;
        if (!substeps.empty()) std::printf("               %s\n", substeps.substr(2).c_str());
        if (gain > 1.0)
            std::printf(
                "               small blocks govern it: with run.substeps: auto %.2g times fewer of them and of their "
                "contacts are computed\n",
                gain);
    } else {
        std::printf(", shorter while blocks move fast\n");
    }
}

Cost print_cost(Simulation& simulation) {
    const int stages = simulation.stage_count();
    const bool timeless = simulation.timeless();
    const Cost cost = predict_cost(simulation);
    std::printf("cost           %d stage%s, %s%.2g %s of about %.2g ms as it begins: %sabout %s in all\n", stages,
                stages == 1 ? "" : "s", cost.bound, cost.steps, timeless ? "iterations" : "steps", 1e3 * cost.per_step,
                cost.bound, duration(cost.seconds).c_str());
    return cost;
}

void print_memory(const Simulation& simulation) {
    const Scenario& scenario = simulation.scenario();
    const Model& model = simulation.model();
    const double frames = scenario.record.frame_every && simulation.recorded_time() > 0.0
                              ? simulation.recorded_time() / *scenario.record.frame_every
                              : scenario.record.frame_count.value_or(50);
    const double bytes =
        60.0 * model.blocks.size() + 12.0 * model.corners.size() +
        (scenario.record.contacts ? 100.0 * static_cast<double>(simulation.state().contacts.list.size()) / 2 : 0.0);
    const MemoryUse memory = memory_use();
    std::printf("memory         %.0f MB in the run, %.0f MB while cutting; results about %s for %.0f frames\n",
                memory.now / 1e6, memory.peak / 1e6, number(frames * bytes / 1e6, "MB").c_str(), frames);
}

void write_geometry(const std::string& path, Simulation& simulation) {
    Recorder recorder(path, simulation, std::vector<std::string>{});
    recorder.write_frame(simulation, with_all_touching_faces(simulation));
    recorder.close("checked");
}

const char* fit_for(const std::string& solver) {
    if (solver == "rigid") return ": blocks and joints without any give; right for what falls, slides, rocks or stands";
    return solver == "explicit" ? ": right where the stiffness of joints counts" : "";
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
    print_cut(simulation);
    print_joints(simulation);
    print_settlement(simulation);
    std::printf("solver         %s%s\n", simulation.stage().solver.c_str(), fit_for(simulation.stage().solver));
    print_decisions(simulation);
    print_step(simulation);
    const std::string long_run = long_stage(simulation);
    const Cost cost = print_cost(simulation);
    if (const std::string text = scenario.run.accuracy ? "" : advice(scenario, simulation, cost); !text.empty())
        std::printf("advice         %s\n", text.c_str());
    print_memory(simulation);
    for (const std::string& warning : simulation.report().warnings) std::printf("warning: %s\n", warning.c_str());
    if (!long_run.empty()) std::printf("warning: %s\n", long_run.c_str());
    return ok;
}

}  // namespace talus::cli
