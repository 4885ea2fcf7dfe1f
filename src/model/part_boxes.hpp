// Where every convex part is now, as a box.
#pragma once

#include "model/model.hpp"
#include "model/placed.hpp"
#include "model/state.hpp"

#include <vector>

namespace talus {

/// [np] m, closed around the corners; that of a part whose block was removed is {1, 1, -1, -1}. `placed` must be up to date.
void part_boxes(const Model& model, const State& state, const Placed& placed, std::vector<Box>& boxes);

}  // namespace talus
