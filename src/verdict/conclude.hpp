// The verdict on a run, from how its blocks went on.
#pragma once

#include "model/model.hpp"
#include "model/state.hpp"
#include "model/verdict.hpp"
#include "verdict/course.hpp"

namespace talus {

/// Of a state that a solver for motion has brought about.
StabilityVerdict conclude(const Model& model, const State& state, const Circumstances& now);

/// Of the end of a static stage: equilibrium, a block that keeps moving or has gone far before it came to rest, or neither
/// within the iterations.
StabilityVerdict conclude_static(const Model& model, const State& state, const Circumstances& now);

}  // namespace talus
