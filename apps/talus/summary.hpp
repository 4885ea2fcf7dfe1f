// What a person wants to know when a run is over.
#pragma once

#include "simulation/error_estimate.hpp"
#include "simulation/expect.hpp"
#include "simulation/simulation.hpp"

#include <string>
#include <vector>

namespace talus::cli {

/// "1.23e6 J", "0.5 mm": a number with four digits and its unit.
std::string number(double value, const char* unit = "");

/// "0.001 of the motion".
std::string in_words(const AccuracySpec& accuracy);

/// What follows the step in a sentence; empty if all blocks take the same.
std::string substeps_in_words(const Simulation& simulation);
void print_stage(const Simulation& simulation);
void print_summary(const Simulation& simulation, double wall_time);
void print_error_estimate(const ErrorEstimate& estimate, const std::optional<AccuracySpec>& accuracy);
/// One line each; returns how many failed.
int print_verdicts(const std::vector<Verdict>& verdicts, const std::string& indent);

}  // namespace talus::cli
