// The verdict on a run, from how its blocks went on.
#pragma once

#include "model/model.hpp"
#include "model/state.hpp"
#include "model/verdict.hpp"

namespace talus {

/// Of a state that a solver for motion has brought about. `loads_are_on`: see Circumstances.
StabilityVerdict conclude(const Model& model, const State& state, bool loads_are_on);

/// Of the end of a static stage: equilibrium, a block that keeps moving, or neither within the iterations.
StabilityVerdict conclude_static(const Model& model, const State& state);

}  // namespace talus
