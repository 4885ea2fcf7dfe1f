// What a run will cost, from a few of its steps.
#pragma once

#include "simulation/simulation.hpp"

#include <string>

namespace talus::cli {

struct Cost {
    double steps = 0.0;      // or iterations
    double per_step = 0.0;   // s of wall time as it begins, median
    double seconds = 0.0;    // of the whole run
    bool known = true;       // false: the first steps took too long to see how others go
    const char* bound = "";  // "at least ", "at most ": a stage ends in equilibrium
};

/// Does some steps of the stage that has just begun. Stages of another solver than that are measured where the last one is.
Cost predict_cost(Simulation& simulation);

/// "3.4 s", "12 min".
std::string duration(double seconds);

/// What another solver would save, or why this one is right; empty if there is nothing to say. `now`: of the simulation.
std::string advice(const Scenario& scenario, const Simulation& simulation, const Cost& now);

}  // namespace talus::cli
