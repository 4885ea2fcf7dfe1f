// What a scenario asks for that depends on the stiffness of its joints.
#pragma once

#include "scenario/scenario.hpp"

#include <string>

namespace talus {

/// Blocks that never give way store nothing in their joints, and have no limit of stability.
bool exists_with_springs_only(const std::string& quantity, const std::string& component);

/// What is recorded or expected, in words; empty if there is nothing of the kind.
/// Of the give of joints itself: closure, elastic shear, oscillations, what is stored; it is that of their stiffness.
std::string asked_of_give(const Scenario& scenario);
/// Forces of joints: in motion they ring; in equilibrium stiffness shares them out where there are more of them than it
/// determines.
std::string asked_of_forces(const Scenario& scenario);
/// How blocks move.
std::string asked_of_movements(const Scenario& scenario);
/// A movement that is no more than `most` of a block of `size` (m), and is not zero within its tolerance.
std::string asked_below(const Scenario& scenario, double most, double size);

}  // namespace talus
