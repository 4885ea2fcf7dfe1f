#include "summary.hpp"

#include "core/memory.hpp"
#include "core/text.hpp"
#include "model/title.hpp"
#include "output/static_table.hpp"
#include "simulation/deep_overlap.hpp"
#include "simulation/trial.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string_view>

namespace talus::cli {
namespace {

// Contacts below this share of the mean force only touch: at rest they tremble about zero, and slide as often as not.
constexpr double light = 0.01;

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
                    title_and_place(model, b).c_str(), number(moved[b], "m").c_str(),
                    degrees(state.motion.angle[b] - state.start_angle[b]),
                    number(state.motion.velocity[b].norm(), "m/s").c_str());
    }
}

double size_of_force(const Contact& c) { return std::hypot(c.normal_force, c.shear_force); }

void print_contacts(const Simulation& simulation) {
    const Contacts& contacts = simulation.state().contacts;
    int touching = 0, loaded = 0, sliding = 0;
    double sum = 0.0;
    for (const Contact& c : contacts.list)
        if (c.touching) ++touching, sum += size_of_force(c);
    for (const Contact& c : contacts.list)
        if (c.touching && size_of_force(c) > light * sum / touching) ++loaded, sliding += c.sliding;
    std::printf("  contacts       %d touch, %d carry more than %.0f %% of the mean force, %d of these slide", touching,
                loaded, 100.0 * light, sliding);
    const Model& model = simulation.model();
    std::ptrdiff_t cells = 0, broken = 0;
    for (const JointFace& face : model.faces) {
        if (!face.bonded) continue;
        const int own = model.joints[face.joint].cells;
        const auto first = contacts.broken.begin() + face.first_cell;
        cells += own;
        broken += own - std::count(first, first + own, 0);
    }
    if (cells > 0) std::printf("; %td of %td bond cells broken", broken, cells);
    std::printf("\n");
}

void print_overlap(const Simulation& simulation) {
    const DeepOverlap deepest = deepest_overlap(simulation.model(), simulation.placed(), simulation.state());
    if (deepest.contact) std::printf("  largest overlap %s\n", describe(simulation.model(), deepest).c_str());
}

void print_energy(const Simulation& simulation) {
    const Energies e = simulation.energies();
    const double turned_over = std::max({std::abs(e.gravity), std::abs(e.loads), std::abs(e.driven), e.kinetic, e.friction,
                                         e.strain_normal, simulation.state().ledger.largest, 1e-300});
    std::printf("  energy         kinetic %s, stored in joints %s, friction %s, damping %s, work of gravity %s\n",
                number(e.kinetic, "J").c_str(), number(e.strain_normal + e.strain_shear, "J").c_str(),
                number(e.friction, "J").c_str(), number(e.contact_damping + e.local_damping, "J").c_str(),
                number(e.gravity, "J").c_str());
    std::printf("  energy drift   %.2g of the largest energy; ledger closes to %.1g\n",
                simulation.energy_drift() / turned_over, std::abs(simulation.ledger_error()) / turned_over);
}

void print_timing(const Simulation& simulation, double wall_time) {
    const auto& seconds = simulation.seconds();
    const double all = std::accumulate(seconds.begin(), seconds.end(), 0.0);
    std::printf(
        "  time           %s for %lld steps (%.0f steps/s), list of pairs renewed %lld times, for %.3g %% of the blocks "
        "each; of the step:",
        number(wall_time, "s").c_str(), static_cast<long long>(simulation.steps_done()),
        static_cast<double>(simulation.steps_done()) / std::max(all, 1e-9), static_cast<long long>(simulation.refreshes()),
        100.0 * static_cast<double>(simulation.boxes_renewed()) /
            std::max<double>(static_cast<double>(simulation.refreshes()) * simulation.model().blocks.size(), 1.0));
    for (std::size_t i = 0; i < seconds.size(); ++i)
        std::printf(" %s %.1f %%%s", part_names[i], 100.0 * seconds[i] / std::max(all, 1e-9),
                    i + 1 < seconds.size() ? "," : "\n");
    if (!simulation.search_choice().empty())
        std::printf("  search         %s: %s\n", simulation.scenario().run.search.c_str(),
                    simulation.search_choice().c_str());
    if (simulation.scenario().run.freeze)
        std::printf("  frozen         %.1f %% of the blocks, in the mean of the steps in which they may\n",
                    100.0 * simulation.frozen_share());
    const MemoryUse memory = memory_use();
    std::printf("  memory         %.0f MB at the end, %.0f MB at most (cutting and frames)\n", memory.now / 1e6,
                memory.peak / 1e6);
}

void print_decisions(const Simulation& simulation) {
    if (!simulation.scenario().run.accuracy) return;
    std::printf("  accuracy       %s", in_words(*simulation.scenario().run.accuracy).c_str());
    for (const Decision& c : simulation.decisions().choices) std::printf("; %s %s", c.what.c_str(), c.value.c_str());
    std::printf("\n");
}

void print_static_stages(const Simulation& simulation) {
    const Statics& statics = simulation.state().statics;
    std::size_t newton = 0;
    for (const StaticEvidence& e : static_stages(statics)) {
        std::printf(
            "  static         stage %d: %s; unbalanced ratio %.2g, drift %.2g of a block per characteristic time; %lld "
            "iterations, %lld evaluations of the forces",
            e.stage + 1, e.reached ? "equilibrium" : "NO EQUILIBRIUM", e.ratio, e.drift,
            static_cast<long long>(e.iterations), static_cast<long long>(e.evaluations));
        if (e.increments > 0)
            std::printf("; load in %lld increments, at most %.2g out of balance", static_cast<long long>(e.increments),
                        e.loading_ratio);
        std::printf("\n");
        if (e.newton_steps == 0) continue;
        std::printf("                 Newton:");
        for (std::int64_t i = 0; i < e.newton_steps; ++i) std::printf(" %.1e", statics.newton_ratios.at(newton++));
        std::printf("\n");
    }
}

void print_verdict(const StabilityVerdict& v) {
    std::printf("  verdict        %s", name_of(v.verdict));
    if (v.moving_blocks > 0)
        std::printf(", %s: %d block%s of %s together, %.3g %% of all that is free, %d detached",
                    v.verdict == Stability::unstable ? name_of(v.mechanism) : "loose stones", v.moving_blocks,
                    v.moving_blocks == 1 ? "" : "s", number(v.moving_area, "m2").c_str(), 100.0 * v.moving_share,
                    v.detached_blocks);
    std::printf("\n                 %s\n", v.reason.c_str());
}

}  // namespace

std::string number(double value, const char* unit) {
    char text[48];
    std::snprintf(text, sizeof text, *unit ? "%.4g %s" : "%.4g", value, unit);
    return text;
}

std::string in_words(const AccuracySpec& accuracy) {
    std::string text;
    if (accuracy.motion) text = number(*accuracy.motion) + " of the motion";
    if (accuracy.joint_stress) text += (text.empty() ? "" : ", ") + number(*accuracy.joint_stress) + " of joint stress";
    return text;
}

std::string substeps_in_words(const Simulation& simulation) {
    const State& state = simulation.state();
    if (state.fast.empty()) return simulation.scenario().run.substeps > 1 ? "; no block is small enough for substeps" : "";
    return "; " + std::to_string(std::count(state.fast.begin(), state.fast.end(), 1)) + " of " +
           std::to_string(state.fast.size()) + " blocks take " + std::to_string(state.substeps) + " substeps in it";
}

void print_stage(const Simulation& simulation) {
    if (simulation.timeless()) {
        std::printf("%s: static, until the unbalanced ratio is below %s\n", simulation.stage().name.c_str(),
                    number(*simulation.stage().until.equilibrium).c_str());
        return;
    }
    const StableStep& stable = simulation.stable();
    if (simulation.stage().solver != "explicit") {
        std::printf("%s: solver %s, step %s\n", simulation.stage().name.c_str(), simulation.stage().solver.c_str(),
                    number(simulation.state().stage_step, "s").c_str());
        return;
    }
    std::printf("%s: step %s (rigorous bound %s, limit estimated at %s)%s\n", simulation.stage().name.c_str(),
                number(simulation.state().stage_step, "s").c_str(), number(stable.bound, "s").c_str(),
                number(stable.estimate, "s").c_str(), substeps_in_words(simulation).c_str());
}

void print_summary(const Simulation& simulation, double wall_time) {
    std::printf("at t = %s:\n", number(simulation.state().time, "s").c_str());
    print_verdict(simulation.verdict());
    print_movers(simulation);
    print_contacts(simulation);
    print_overlap(simulation);
    print_energy(simulation);
    print_static_stages(simulation);
    std::printf("  unbalanced     %.2g of the mean contact force\n",
                unbalanced_ratio(simulation.model(), simulation.state()));
    for (const std::string& warning : run_warnings(simulation)) std::printf("  WARNING: %s\n", warning.c_str());
    if (simulation.state().step_halvings > 0)
        std::printf("  note: the step is halved %d times now, because blocks move fast against the thinnest one\n",
                    simulation.state().step_halvings);
    print_decisions(simulation);
    print_timing(simulation, wall_time);
}

void print_error_estimate(const ErrorEstimate& estimate, const std::optional<AccuracySpec>& accuracy) {
    std::printf("error, estimated from a run %s:\n", estimate.how.c_str());
    for (const ErrorOf& e : estimate.of)
        std::printf("  %-52s %-14.7g finer %-14.7g error about %.2g\n", e.what.c_str(), e.value, e.finer, e.error);
    if (!accuracy) return;
    std::printf("  accuracy asked for: %s\n", in_words(*accuracy).c_str());
    if (!accuracy->motion) return;
    const bool held = estimate.of_motion <= *accuracy->motion;
    std::printf("  %s: the largest displacement is wrong by about %.2g of the motion%s\n",
                held ? "held" : "WARNING: not held", estimate.of_motion,
                held ? ""
                     : "; where a smaller run.accuracy does not help, what moves hangs on impacts or jammed joints that the "
                       "scene does not determine");
}

int print_verdicts(const std::vector<Verdict>& verdicts, const std::string& indent) {
    int failed = 0;
    for (const Verdict& v : verdicts) {
        std::printf("%s%s  %-52s measured %-12.7g ", indent.c_str(), v.passed ? "ok    " : "FAILED", v.what.c_str(),
                    v.measured);
        if (v.asked == std::string_view("expected"))
            std::printf("expected %-12.7g error %-9.2g allowed %.2g\n", v.expected, v.error, v.allowed);
        else
            std::printf("%-8s %.7g\n", v.asked, v.expected);
        failed += !v.passed;
    }
    return failed;
}

}  // namespace talus::cli
