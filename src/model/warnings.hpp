// What a scene is allowed to be, but seldom meant to be.
#pragma once

#include "model/initial_stress.hpp"
#include "model/model.hpp"
#include "model/neighbours.hpp"
#include "scenario/scenario.hpp"

#include <string>
#include <vector>

namespace talus {

/// Sentences for the user; empty if nothing looks odd. faces_per_joint as in BuildReport.
std::vector<std::string> warnings(const Scenario& scenario, const Model& model, const Neighbours& neighbours,
                                  const Prestress& prestress, const std::vector<int>& faces_per_joint);

}  // namespace talus
