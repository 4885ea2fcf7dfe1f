#include "cost.hpp"

#include "core/errors.hpp"
#include "core/stopwatch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace talus::cli {
namespace {

constexpr int warm_up_steps = 10;     // while memory is got and the first contacts and impulses are found
constexpr int trial_steps = 30;       // at least; a rigid mass takes a second to find its first impulses
constexpr double trial_time = 0.5;    // s; shorter and what else the machine does shows, longer and the user waits
constexpr double longest_trial = 2;   // s
constexpr double iterations = 300.0;  // of a static stage, mostly 100 to 1000
constexpr double worth_saying = 1.5;  // times faster
constexpr int most_rigid =
    5000;  // blocks of which rigid steps are tried for advice: more may take minutes for the first one

// s, the median: other work on the machine makes single steps slower, none faster.
double time_of_a_step(Simulation& simulation) {
    std::vector<double> seconds;
    const Stopwatch clock;
    for (int i = 0;
         (clock.seconds() < trial_time || (i < trial_steps && clock.seconds() < longest_trial)) && !simulation.stage_over();
         ++i) {
        const Stopwatch step;
        simulation.step();
        if (i >= warm_up_steps || seconds.empty()) seconds.push_back(step.seconds());
    }
    if (seconds.empty()) return 0.0;
    const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
    std::nth_element(seconds.begin(), middle, seconds.end());
    return *middle;
}

struct Stages {
    double time = 0.0;  // s, of those with the solver of a simulation
    int timeless = 0;   // static ones
    bool may_end_before = false, has_no_end = false;
};

/// Stages that are computed by the solver of the one that has begun.
Stages stages_like(const Simulation& simulation, const std::string& solver) {
    Stages found;
    const Scenario& scenario = simulation.scenario();
    const auto count = [&](const std::string& name, const Until& until) {
        if ((name == "auto" ? "explicit" : name) != solver) return;
        if (solver == "static") {
            ++found.timeless;
            return;
        }
        found.time += until.time.value_or(0.0);
        found.may_end_before |= (until.equilibrium || until.verdict) && until.time;
        found.has_no_end |= !until.time;
    };
    for (const StageSpec& stage : scenario.stages) count(stage.solver, stage.until);
    if (scenario.run.until.time || scenario.run.until.equilibrium) count(scenario.run.solver, scenario.run.until);
    return found;
}

Cost cost_of_stages(Simulation& simulation) {
    const Stages stages = stages_like(simulation, simulation.stage().solver);
    const double dt = simulation.state().stage_step;
    Cost cost;
    const std::int64_t before = simulation.steps_done();
    cost.per_step = time_of_a_step(simulation);
    cost.known = simulation.steps_done() - before > warm_up_steps || simulation.stage_over();
    cost.steps = simulation.timeless() ? iterations * stages.timeless : stages.time / dt;
    if (simulation.timeless() && simulation.stage_over()) cost.steps = static_cast<double>(simulation.steps_done());
    cost.seconds = cost.steps * cost.per_step;
    const bool may_halve = simulation.stage().solver == "rigid";  // while blocks move fast
    cost.bound = stages.has_no_end || may_halve ? "at least " : stages.may_end_before ? "at most " : "";
    return cost;
}

/// The last stage alone, with another solver than the first; nothing if it is the same or cannot begin by itself.
Cost cost_of_the_end(const Simulation& simulation) {
    Scenario last = simulation.scenario();
    const bool runs = last.run.until.time || last.run.until.equilibrium;
    if (last.stages.empty() || !runs || last.run.solver == simulation.stage().solver) return {};
    last.stages.clear();
    try {
        Simulation end(last, build(last));
        end.begin_stage();
        return cost_of_stages(end);
    } catch (const InputError&) {  // what it names is made by a stage
        return {};
    } catch (const DivergenceError&) {
        return {};
    }
}

}  // namespace

Cost predict_cost(Simulation& simulation) {
    Cost cost = cost_of_stages(simulation);
    const Cost end = cost_of_the_end(simulation);
    cost.seconds += end.seconds;
    if (*cost.bound == 0) cost.bound = end.bound;
    return cost;
}

std::string duration(double seconds) {
    const auto [size, unit] = seconds < 120.0    ? std::pair(1.0, "s")
                              : seconds < 7200.0 ? std::pair(60.0, "min")
                                                 : std::pair(3600.0, "h");
    char text[32];
    std::snprintf(text, sizeof text, "%.2g %s", seconds / size, unit);
    return text;
}

std::string advice(const Scenario& scenario, const Simulation& simulation, const Cost& now) {
    Scenario other = scenario;
    other.run.accuracy = AccuracySpec{1e-3, {}, {}};
    other.run.solver = "auto";
    other.run.time_step.reset();
    const bool damped = other.run.damping.contact > 0.0 || other.run.damping.local > 0.0;
    other.run.damping = {};
    for (StageSpec& stage : other.stages) {
        stage.solver = "auto";
        stage.time_step.reset();
        stage.damping.contact = 0.0;
        if (!stage.settle) stage.damping.local = 0.0;
    }
    try {
        Simulation chosen(other, build(other));
        chosen.begin_stage();
        const Decision& solver = chosen.decisions().choices.front();
        if (chosen.scenario().run.solver == simulation.scenario().run.solver ||
            (chosen.scenario().run.solver == "explicit" && simulation.scenario().run.solver == "auto"))
            return "solver " + chosen.scenario().run.solver + " is right: " + solver.why;
        const bool large = chosen.scenario().run.solver == "rigid" && chosen.model().blocks.size() > most_rigid;
        const Cost then = large ? Cost{.known = false} : predict_cost(chosen);
        if (then.known && now.known && then.seconds > now.seconds) return {};
        std::string text =
            "solver: " + chosen.scenario().run.solver + (damped ? ", without damping," : "") + " would do: " + solver.why;
        if (then.known) text += "; to 1e-3 of the motion it takes about " + duration(then.seconds);
        if (then.known && now.seconds > worth_saying * then.seconds) text += " instead of " + duration(now.seconds);
        return text + " (run.accuracy: 1e-3 chooses it)";
    } catch (const InputError&) {  // no solver would hold so much: then nothing can be left out
        return {};
    } catch (const DivergenceError&) {
        return {};
    }
}

}  // namespace talus::cli
