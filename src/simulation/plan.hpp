// What a scenario leaves open and its `run.accuracy` decides: solvers, steps, stiffness, freezing.
#pragma once

#include "model/build.hpp"
#include "scenario/scenario.hpp"

#include <string>
#include <vector>

namespace talus {

struct Decision {
    std::string what, value, why;  // "run.time_step", "0.0025 s", "..."
};

struct Decisions {
    std::vector<Decision> choices;      // empty without an accuracy
    std::vector<std::string> warnings;  // where a key that is given may cost more than the accuracy
    bool give_is_error = false;         // what joints close is error, and no part of the answer
    std::string remedy;                 // what a scenario may state so that it needs no springs; mostly empty
};

struct Plan : Decisions {
    Scenario scenario;  // with nothing left open
};

/// Without an accuracy the scenario as it is. Depends on the scenario alone, so that a run which is resumed goes on as it
/// was. Throws InputError if no solver, or not the one that is given, can hold the accuracy: why, and what can be reached.
Plan make_plan(const Scenario& scenario, const Scene& scene);

/// The stiffness of joints as the scenario has it now, into a scene that may have been built without.
void stiffen(const Scenario& scenario, Model& model, State& state);

}  // namespace talus
