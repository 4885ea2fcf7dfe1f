#include "simulation/error_estimate.hpp"

#include "simulation/run.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

// Nearly half: what falls between two steps of the one run must not fall at the same place of those of the other.
constexpr double shorter = 0.45;

ExpectSpec at_the_end(const ProbeSpec& probe) {
    ExpectSpec expect;
    expect.probe = probe;
    expect.measure = "value";
    expect.value = 0.0;
    return expect;
}

struct Finer {
    Scenario scenario;
    std::string how;
    double left;  // share of the error of the run that the finer one still has
};

void stiffen(std::vector<JointSpec>& joints) {
    for (JointSpec& joint : joints) joint.normal_stiffness *= 4.0, joint.shear_stiffness *= 4.0;
}

Finer finer(const Simulation& done, const std::vector<double>& steps) {
    const bool give_is_error = done.decisions().give_is_error;
    Finer f{done.scenario(), "with steps of 0.45 of the length", shorter * shorter};
    RunSpec& run = f.scenario.run;
    run.accuracy.reset();  // what was chosen must not be chosen anew
    run.step_fraction *= shorter;
    run.most_travel = shorter * run.most_travel.value_or(0.5 * done.stable().thinnest);  // where the step is halved, too
    bool rigid = false, springs = false, motion = false;
    const auto refine = [&](std::size_t i, const std::string& solver, Until& until, DampingSpec& damping,
                            std::optional<double>& time_step) {
        rigid |= solver == "rigid", springs |= solver != "rigid", motion |= solver != "static";
        if (solver == "static" && until.equilibrium) *until.equilibrium *= 0.1;
        if (solver == "rigid" || time_step) time_step = shorter * (time_step ? *time_step : steps.at(i));
        if (give_is_error) damping.contact *= 0.5;  // the same share of the critical damping
    };
    std::vector<StageSpec>& stages = f.scenario.stages;
    for (std::size_t i = 0; i < stages.size(); ++i)
        refine(i, stages[i].solver, stages[i].until, stages[i].damping, stages[i].time_step);
    if (steps.size() > stages.size()) refine(stages.size(), run.solver, run.until, run.damping, run.time_step);

    if (rigid) f.left = shorter;
    if (!motion) f.how = "with a tenth of the unbalanced ratio", f.left = 0.1;
    if (give_is_error && springs) {
        run.step_fraction /= shorter;  // stiffness halves the step already
        stiffen(f.scenario.joints);
        for (StageSpec& stage : stages) stiffen(stage.joints);
        f.how = "with joints four times as stiff", f.left = motion ? 0.5 : 0.25;
    }
    return f;
}

/// m, square root of the mean area of the blocks that are free.
double mean_size(const Model& model) {
    double area = 0.0;
    int free = 0;
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        if (!model.blocks.held(b)) area += model.blocks.area[b], ++free;
    return free > 0 ? std::sqrt(area / free) : 1.0;
}

}  // namespace

std::vector<ExpectSpec> watched_for_error(const Scenario& scenario) {
    ProbeSpec farthest;
    farthest.quantity = "max_displacement";
    std::vector<ExpectSpec> all{at_the_end(farthest)};
    for (const HistorySpec& history : scenario.record.history)
        for (const ProbeSpec& probe : history.probes) all.push_back(at_the_end(probe));
    for (ExpectSpec expect : scenario.expect) {
        if (about_what_is_told(expect)) continue;
        expect.same_as.clear();
        expect.value = 0.0;
        all.push_back(expect);
    }
    return all;
}

ErrorEstimate estimate_error(const Simulation& done, const std::vector<double>& steps,
                             const std::vector<Verdict>& measured) {
    const Finer again = finer(done, steps);
    Simulation simulation(again.scenario, build(again.scenario));
    Watch watch(watched_for_error(done.scenario()), simulation.model(), simulation.first_state());
    RunOptions options;
    options.watch = &watch;
    run(simulation, options);
    const std::vector<Verdict> finer = watch.judge();
    ErrorEstimate estimate{again.how, {}, 0.0};
    for (std::size_t i = 0; i < std::min(measured.size(), finer.size()); ++i)
        estimate.of.push_back({measured[i].what, measured[i].measured, finer[i].measured,
                               std::abs(measured[i].measured - finer[i].measured) / (1.0 - again.left)});
    if (!estimate.of.empty()) {
        const ErrorOf& farthest = estimate.of.front();
        estimate.of_motion = farthest.error / std::max({farthest.value, farthest.finer, mean_size(done.model())});
    }
    return estimate;
}

}  // namespace talus
