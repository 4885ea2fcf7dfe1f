// What is done with all boxes at every step, in the widest vector registers there are.
#pragma once

#include "contact/regions.hpp"
#include "contact/watched.hpp"

namespace talus {

/// Every box of which a bound is further than the radius from that of its reference, or is not a number; in order.
void find_escaped(std::span<const Box> boxes, const Vec2& centre, const Regions& regions, std::vector<int>& escaped);

/// Notes which pairs overlap.
void compare_watched(std::span<const Box> boxes, WatchedPairs& pairs);

/// Compares boxes 64 x word to 64 x word + 63 with those beyond their upper bounds.
void compare_upper_bounds(std::span<const Box> boxes, int word, UpperBounds& bounds);

}  // namespace talus
