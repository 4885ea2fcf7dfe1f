// Where every convex part is now, as a box.
#pragma once

#include "model/model.hpp"
#include "model/placed.hpp"
#include "model/state.hpp"

#include <cstdint>
#include <vector>

namespace talus {

/// [np] m, closed around the corners, along the axes of Model::box_axis; that of a part whose block was removed is {1, 1,
/// -1, -1}. `placed` must be up to date.
void part_boxes(const Model& model, const State& state, const Placed& placed, std::vector<Box>& boxes);

/// Blocks that have moved by more than this share of the skin get new boxes together with the one that left its own: each
/// alone would come soon after.
inline constexpr double kept_share = 0.25;

/// New boxes, grown by the skin, for the blocks that have left theirs or soon may; for all if there are none yet.
/// `reboxed` [nb]: 1 for those. Returns how many.
int rebox(const Model& model, const State& state, double skin, Placed& placed, std::vector<Box>& boxes,
          std::vector<std::uint8_t>& reboxed);

}  // namespace talus
