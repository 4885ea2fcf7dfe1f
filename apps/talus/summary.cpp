#include "summary.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace talus::cli {
namespace {

std::string place(const Model& model, BlockId b) {
    const Vec2 at = model.blocks.start[b] + model.origin;
    char text[96];
    std::snprintf(text, sizeof text, "block %d%s%s%s at (%.6g, %.6g)", b, model.blocks.name[b].empty() ? "" : " '",
                  model.blocks.name[b].c_str(), model.blocks.name[b].empty() ? "" : "'", at.x(), at.y());
    return text;
}

void print_movers(const Simulation& simulation) {
    const Model& model = simulation.model();
    const State& state = simulation.state();
    std::vector<BlockId> order;
    std::vector<double> moved(model.blocks.size());
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (state.removed[b]) continue;
        moved[b] = (state.motion.position[b] - state.start_position[b]).norm();
        order.push_back(b);
    }
    const std::size_t shown = std::min<std::size_t>(3, order.size());
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(shown), order.end(),
                      [&](BlockId a, BlockId b) { return moved[a] > moved[b] || (moved[a] == moved[b] && a < b); });
    for (std::size_t i = 0; i < shown && moved[order[i]] > 0.0; ++i) {
        const BlockId b = order[i];
        std::printf("  %s %s: moved %s, turned %.3g deg, speed %s\n", i == 0 ? "largest movers" : "              ",
                    place(model, b).c_str(), number(moved[b], "m").c_str(),
                    degrees(state.motion.angle[b] - state.start_angle[b]),
                    number(state.motion.velocity[b].norm(), "m/s").c_str());
    }
}

void print_overlap(const Simulation& simulation) {
    const Model& model = simulation.model();
    double deepest = 0.0;
    const Contact* worst = nullptr;
    int touching = 0, sliding = 0;
    for (const Contact& c : simulation.state().contacts.list) {
        if (!c.touching) continue;
        ++touching;
        sliding += c.sliding;
        if (c.overlap > deepest) deepest = c.overlap, worst = &c;
    }
    const auto broken = std::count_if(simulation.state().contacts.broken.begin(), simulation.state().contacts.broken.end(),
                                      [](std::uint8_t b) { return b != 0; });
    std::printf("  contacts       %d carry force, %d slide", touching, sliding);
    if (!simulation.state().contacts.broken.empty())
        std::printf(", %td of %zu bond cells broken", broken, simulation.state().contacts.broken.size());
    std::printf("\n");
    if (!worst) return;
    const double shortest = *std::min_element(model.corners.length.begin(), model.corners.length.end());
    const double thin = std::min(model.parts.thickness[worst->part_a], model.parts.thickness[worst->part_b]);
    std::printf("  largest overlap %s: %.2g of the shortest edge (%s)\n", number(deepest, "m").c_str(), deepest / shortest,
                number(shortest, "m").c_str());
    if (deepest > 0.05 * thin)
        std::printf(
            "  warning: an overlap of %.0f %% of the thinner block between blocks %d and %d; a normal stiffness of %s "
            "would keep it below 1 %%\n",
            100.0 * deepest / thin, model.parts.block[worst->part_a], model.parts.block[worst->part_b],
            number(model.joints[worst->joint].kn * deepest / (0.01 * thin), "Pa/m").c_str());
}

void print_energy(const Simulation& simulation) {
    const Energies e = simulation.energies();
    const double turned_over = std::max(
        {std::abs(e.gravity), std::abs(e.loads), std::abs(e.driven), e.kinetic, e.friction, e.strain_normal, 1e-300});
    std::printf("  energy         kinetic %s, stored in joints %s, friction %s, damping %s, work of gravity %s\n",
                number(e.kinetic, "J").c_str(), number(e.strain_normal + e.strain_shear, "J").c_str(),
                number(e.friction, "J").c_str(), number(e.contact_damping + e.local_damping, "J").c_str(),
                number(e.gravity, "J").c_str());
    std::printf("  energy drift   %.2g of the largest of them; ledger closes to %.1g\n",
                simulation.energy_drift() / turned_over, std::abs(simulation.ledger_error()) / turned_over);
    if (simulation.energy_gain() > energy_alarm)
        std::printf(
            "  WARNING: blocks gained energy from nowhere, %.2g of the largest energy of the run: do not trust these "
            "results; a shorter step (run.time_step, run.step_fraction) or contact damping is the remedy\n",
            simulation.energy_gain());
}

void print_timing(const Simulation& simulation, double wall_time) {
    const auto& seconds = simulation.seconds();
    const double all = std::accumulate(seconds.begin(), seconds.end(), 0.0);
    std::printf("  time           %s for %lld steps (%.0f steps/s), list of pairs made %lld times; of the step:",
                number(wall_time, "s").c_str(), static_cast<long long>(simulation.steps_done()),
                static_cast<double>(simulation.steps_done()) / std::max(all, 1e-9),
                static_cast<long long>(simulation.refreshes()));
    for (std::size_t i = 0; i < seconds.size(); ++i)
        std::printf(" %s %.1f %%%s", part_names[i], 100.0 * seconds[i] / std::max(all, 1e-9),
                    i + 1 < seconds.size() ? "," : "\n");
}

}  // namespace

std::string number(double value, const char* unit) {
    char text[48];
    std::snprintf(text, sizeof text, *unit ? "%.4g %s" : "%.4g", value, unit);
    return text;
}

std::string out_of_time(const Simulation& simulation) {
    const StageSpec& stage = simulation.stage();
    return "stage " + stage.name + " did not come to equilibrium in its " + number(*stage.until.time, "s") +
           ": unbalanced ratio " + number(unbalanced_ratio(simulation.model(), simulation.state())) + ", not below " +
           number(*stage.until.equilibrium);
}

void print_stage(const Simulation& simulation) {
    const StableStep& stable = simulation.stable();
    std::printf("%s: step %s (rigorous bound %s, limit estimated at %s)\n", simulation.stage().name.c_str(),
                number(simulation.state().stage_step, "s").c_str(), number(stable.bound, "s").c_str(),
                number(stable.estimate, "s").c_str());
}

void print_summary(const Simulation& simulation, double wall_time) {
    std::printf("at t = %s:\n", number(simulation.state().time, "s").c_str());
    print_movers(simulation);
    print_overlap(simulation);
    print_energy(simulation);
    std::printf("  unbalanced     %.2g of the mean contact force\n",
                unbalanced_ratio(simulation.model(), simulation.state()));
    if (simulation.state().step_halvings > 0)
        std::printf("  note: the step is halved %d times now, because blocks move fast against the thinnest one\n",
                    simulation.state().step_halvings);
    print_timing(simulation, wall_time);
}

int print_verdicts(const std::vector<Verdict>& verdicts, const std::string& indent) {
    int failed = 0;
    for (const Verdict& v : verdicts) {
        std::printf("%s%s  %-52s measured %-12.7g expected %-12.7g error %-9.2g allowed %.2g\n", indent.c_str(),
                    v.passed ? "ok    " : "FAILED", v.what.c_str(), v.measured, v.expected, v.error, v.allowed);
        failed += !v.passed;
    }
    return failed;
}

}  // namespace talus::cli
