// An order of boxes in which those that follow each other lie near each other.
#pragma once

#include "contact/viewpoint.hpp"

namespace talus {

/// Columns as wide as `together` boxes lie in a square, up one and down the next; boxes of different size, each a factor of
/// 4, one after the other. Every size begins at a multiple of `together`: places left free are -1. Boxes that are not
/// present have no place. O(N)
std::vector<int> spatial_order(std::span<const Box> boxes, const Viewpoint& view, int together);

}  // namespace talus
