// Whole runs driven step by step, with a look at the simulation, or a change of it, after every step.
#pragma once

#include "model/hash.hpp"
#include "scenario/reader.hpp"
#include "simulation/simulation.hpp"

#include <optional>
#include <string>
#include <vector>

namespace talus::test {

/// A simulation that can be replaced while it runs, by one that goes on from its saved state.
class WholeRun {
public:
    explicit WholeRun(const Scenario& scenario) : WholeRun(scenario, build(scenario)) {}
    WholeRun(const Scenario& scenario, Scene scene) { simulation_.emplace(scenario, std::move(scene)); }

    /// To the end of the last stage; `after_step(*this)` is called after every step.
    template <class AfterStep>
    void to_the_end(AfterStep after_step) {
        do {
            simulation_->begin_stage();
            while (!simulation_->stage_over()) {
                simulation_->step();
                after_step(*this);
            }
        } while (simulation_->end_stage());
    }
    void to_the_end() {
        to_the_end([](WholeRun&) {});
    }

    Simulation& simulation() { return *simulation_; }
    const Model& model() const { return simulation_->model(); }
    const State& state() const { return simulation_->state(); }

    void go_on_from(State saved) {
        const Scenario scenario = simulation_->scenario();
        simulation_.emplace(scenario, build(scenario), std::move(saved));
    }

private:
    std::optional<Simulation> simulation_;
};

/// Of the state after every `interval`-th step, and after whatever `after_step` did then.
template <class AfterStep>
std::vector<std::uint64_t> hashes_of(const Scenario& scenario, int interval, AfterStep after_step) {
    WholeRun run(scenario);
    std::vector<std::uint64_t> hashes;
    run.to_the_end([&](WholeRun& r) {
        after_step(r);
        if (r.state().total_steps % interval == 0) hashes.push_back(state_hash(r.model(), r.state()));
    });
    return hashes;
}

inline Scenario scenario_of(const std::string& text) { return read_scenario_text(text, "test.yaml", "."); }

}  // namespace talus::test
