// A scene that has not run, for a picture of it.
#pragma once

#include "simulation/simulation.hpp"

namespace talus {

/// The first state with one contact for every stretch where two parts touch, loaded or not: position, direction, length,
/// joint.
State with_all_touching_faces(const Simulation& simulation);

}  // namespace talus
