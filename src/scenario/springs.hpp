// What a scenario asks for that depends on the stiffness of its joints.
#pragma once

#include "scenario/scenario.hpp"

#include <string>

namespace talus {

/// Blocks that never give way store nothing in their joints, and have no limit of stability.
bool exists_with_springs_only(const std::string& quantity, const std::string& component);

/// What is recorded or expected that joints of another stiffness would change, in words; empty if there is nothing of the
/// kind. Forces of joints are: where there are more of them than equilibrium determines, stiffness shares them out.
std::string asked_of_springs(const Scenario& scenario);

}  // namespace talus
