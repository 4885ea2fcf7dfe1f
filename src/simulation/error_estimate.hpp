// What a run may be wrong by, from a second, finer run of the same scenario.
#pragma once

#include "scenario/scenario.hpp"
#include "simulation/expect.hpp"
#include "simulation/simulation.hpp"

#include <string>
#include <vector>

namespace talus {

struct ErrorOf {
    std::string what;
    double value = 0.0, finer = 0.0;  // of the run, and of the finer one
    double error = 0.0;               // of the run, estimated
};

struct ErrorEstimate {
    std::string how;          // "with steps of 0.45 of the length"
    std::vector<ErrorOf> of;  // the largest displacement first
    double of_motion = 0.0;   // error of that, as a share of it; where blocks hardly move, of the size of a mean one
};

/// What is watched in a run whose error is to be estimated: the largest displacement, every history at its end, and what the
/// scenario expects in numbers. To be judged by a Watch of both runs.
std::vector<ExpectSpec> watched_for_error(const Scenario& scenario);

/// Runs the scenario of a run that is over again, with steps of 0.45 of the length, and compares with what that measured
/// (verdicts of watched_for_error). `steps`: s, of its stages, as they were chosen. An error of order p leaves a share of
/// 0.45^p of itself to the finer run, so it is 1 / (1 - 0.45^p) of the difference [richardson1911]: p = 1 for rigid blocks,
/// whose impacts come up to a step early or late, p = 2 for springs. Where what joints close counts as error, stiffness is
/// four times as high instead, which halves the step: errors fall with its square root, in static stages in proportion.
/// Static stages without that get a tenth of their unbalanced ratio. Throws what a run throws.
ErrorEstimate estimate_error(const Simulation& done, const std::vector<double>& steps, const std::vector<Verdict>& measured);

}  // namespace talus
