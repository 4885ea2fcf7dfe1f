// A scenario that is run for the sake of what it expects.
#pragma once

#include "simulation/expect.hpp"
#include "simulation/simulation.hpp"

#include <map>
#include <string>
#include <vector>

namespace talus {

struct Trial {
    std::vector<Verdict> verdicts;  // in the order of the expectations; NaN where the run did not get there
    std::string trouble;            // why the scene was refused or the run ended early, unless that was expected
    std::string solver;             // of the last stage; `auto` if the scene was refused before one was chosen
    bool passed() const;
};

/// Builds and runs the scenario and judges it, whatever becomes of it. `earlier`: the cases of the file that were tried
/// before, by name, for expectations that are `same_as` one of them. Throws nothing that the scenario could be guilty of.
Trial try_out(const Scenario& scenario, const std::map<std::string, Trial>& earlier = {});

/// The expectations with values in place of `same_as`; NaN, which nothing meets, where the case was not tried.
std::vector<ExpectSpec> with_values(const std::vector<ExpectSpec>& expects, const std::map<std::string, Trial>& earlier);

/// Sentences about how the run went, empty if nothing looks odd: energy from nowhere, deep overlaps.
std::vector<std::string> run_warnings(const Simulation& simulation);

/// What to say of a stage that has begun and will take very long; empty if it will not.
std::string long_stage(const Simulation& simulation);

/// What to say at the end of a stage that was to end in equilibrium and did not.
std::string out_of_time(const Simulation& simulation, const Unsettled& stage);

}  // namespace talus
