// All pairs at once, for the first step and whenever more has changed than is worth following.
#pragma once

#include "core/types.hpp"

namespace talus {

/// Overlapping pairs a < b of boxes whose ends are given in order along x and y, as 2 box, + 1 for an upper end, lower ends
/// first where coordinates are equal; each pair once, in no particular order. The plane is cut into layers, and each is
/// swept along x: a box meets only the few of its own layer, where a sweep of the whole plane would meet a column of
/// sqrt(N).
std::vector<Pair> strip_sweep(std::span<const Box> boxes, std::span<const int> x_ends, std::span<const int> y_ends);

}  // namespace talus
