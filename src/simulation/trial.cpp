#include "simulation/trial.hpp"

#include "core/errors.hpp"
#include "core/text.hpp"
#include "model/title.hpp"
#include "output/static_table.hpp"
#include "simulation/deep_overlap.hpp"
#include "simulation/run.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace talus {
namespace {

constexpr double many_steps = 1e8;  // a minute or two for a single block, hours for a small scene
constexpr double deep = 0.05;       // share of the thinner part: contact forces are still right, positions off by as much

std::vector<Verdict> judge_unbuilt(const std::vector<ExpectSpec>& expects, const Told& told) {
    std::vector<Verdict> verdicts;
    for (const ExpectSpec& e : expects)
        verdicts.push_back(about_what_is_told(e) ? judge(e, told) : judge(e, e.probe.quantity, Signal{}));
    return verdicts;
}

std::string out_of_iterations(const Simulation& simulation, const StageSpec& stage, const StaticEvidence& now) {
    const std::string ratio = "unbalanced ratio " + number(now.ratio) + ", asked for " + number(*stage.until.equilibrium);
    if (now.moving < 0)
        return "stage " + stage.name + " did not come to equilibrium in " + std::to_string(now.iterations) +
               " iterations: " + ratio + ", drift " + number(now.drift);
    return "stage " + stage.name + " has no equilibrium: " + title_and_place(simulation.model(), now.moving) +
           " keeps moving; " + ratio;
}

}  // namespace

bool Trial::passed() const {
    return trouble.empty() && std::all_of(verdicts.begin(), verdicts.end(), [](const Verdict& v) { return v.passed; });
}

std::vector<ExpectSpec> with_values(const std::vector<ExpectSpec>& expects, const std::map<std::string, Trial>& earlier) {
    std::vector<ExpectSpec> all = expects;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].same_as.empty()) continue;
        const auto found = earlier.find(all[i].same_as);
        const bool there = found != earlier.end() && i < found->second.verdicts.size();
        all[i].value = there ? found->second.verdicts[i].measured : std::nan("");
    }
    return all;
}

Trial try_out(const Scenario& scenario, const std::map<std::string, Trial>& earlier) {
    const std::vector<ExpectSpec> expects = with_values(scenario.expect, earlier);
    Told told;
    std::optional<Simulation> simulation;
    std::optional<Watch> watch;
    try {
        simulation.emplace(scenario, build(scenario));
        watch.emplace(expects, simulation->model(), simulation->first_state());
        RunOptions options;
        options.watch = &*watch;
        // Where one looks for it, to find no equilibrium is an answer like any other.
        const bool asked = std::ranges::any_of(
            expects, [](const ExpectSpec& e) { return e.probe.quantity == "equilibrium" || about_the_verdict(e); });
        options.stage_begun = [&](const Simulation& s) {
            if (const std::string warning = long_stage(s); !warning.empty()) told.warnings.push_back(warning);
        };
        run(*simulation, options);
        const std::vector<Unsettled>& unsettled = simulation->state().unsettled;
        if (!asked && !unsettled.empty()) told.fault = out_of_time(*simulation, unsettled.back());
        told.verdict = simulation->verdict();
    } catch (const DivergenceError& error) {
        told.fault = std::string("diverged: ") + error.what();
    } catch (const InputError& error) {
        told.fault = error.what();
    }
    if (simulation) {
        for (const std::vector<std::string>& more : {simulation->report().warnings, run_warnings(*simulation)})
            told.warnings.insert(told.warnings.end(), more.begin(), more.end());
    }
    Trial trial{watch ? watch->judge(told) : judge_unbuilt(expects, told), told.fault, scenario.run.solver};
    if (simulation) trial.solver = simulation->stage().solver;
    for (std::size_t i = 0; i < expects.size(); ++i)
        if (expects[i].measure == "fault" && trial.verdicts[i].passed) trial.trouble.clear();
    return trial;
}

std::vector<std::string> run_warnings(const Simulation& simulation) {
    std::vector<std::string> all;
    const DeepOverlap deepest = deepest_overlap(simulation.model(), simulation.placed(), simulation.state());
    if (deepest.share() > deep)
        all.push_back("blocks lie deep in each other: overlap " + describe(simulation.model(), deepest) + "; " +
                      (simulation.stage().solver == "rigid" ? rigid_remedy : remedy(simulation.model(), deepest)));
    if (simulation.energy_gain() > energy_alarm)
        all.push_back("blocks gained energy from nowhere, " + number(simulation.energy_gain()) +
                      " of the largest energy of the run: do not trust these results; a shorter step (run.time_step, "
                      "run.step_fraction) or contact damping is the remedy");
    if (const Unsolved& unsolved = simulation.state().unsolved; unsolved.steps > 0)
        all.push_back("in " + std::to_string(unsolved.steps) + " of " + std::to_string(simulation.state().total_steps) +
                      " steps the rigid solver did not find the impulses to the end: relative velocities of up to " +
                      number(unsolved.speed) + " m/s were left, and blocks may have crept by about " + number(unsolved.way) +
                      " m against each other; a shorter time step (run.time_step) or, for what stands, solver: static is "
                      "the remedy");
    return all;
}

std::string long_stage(const Simulation& simulation) {
    const StageSpec& stage = simulation.stage();
    if (simulation.timeless() || !stage.until.time) return {};
    const double steps = *stage.until.time / simulation.state().stage_step;
    if (!(steps >= many_steps)) return {};
    char count[32];
    std::snprintf(count, sizeof count, "%.1e", steps);
    const std::string& remedy = simulation.decisions().remedy;
    return "stage " + stage.name + " takes " + count + " steps of " + number(simulation.state().stage_step) + " s: " +
           (!remedy.empty()                      ? remedy
            : stage.solver == "rigid"            ? "a longer run.time_step takes fewer"
            : simulation.scenario().run.accuracy ? "a larger run.accuracy, or softer joints, take fewer"
                                                 : "softer joints, or solver: rigid where it will do, take fewer");
}

std::string out_of_time(const Simulation& simulation, const Unsettled& found) {
    const StageSpec& stage = simulation.stage(found.stage);
    for (const StaticEvidence& evidence : static_stages(simulation.state().statics))
        if (evidence.stage == found.stage) return out_of_iterations(simulation, stage, evidence);
    return "stage " + stage.name + " did not come to equilibrium in its " + number(*stage.until.time) +
           " s: unbalanced ratio " + number(found.ratio) + ", not below " + number(*stage.until.equilibrium);
}

}  // namespace talus
