// Geometry turned to where the blocks are now. Scratch: made anew from Model and Motion at every step, and laid out so that
// what a contact reads lies together.
#pragma once

#include "core/types.hpp"

#include <vector>

namespace talus {

struct PlacedCorner {
    Vec2 arm;     // m, from the centroid of the block, turned
    Vec2 normal;  // outward unit normal of the edge that starts here, turned
};

struct PlacedBlock {
    Vec2 position, velocity;  // m, m/s, of the centroid
    double spin;              // rad/s
};

struct Placed {
    std::vector<PlacedCorner> corner;  // [nc]
    std::vector<PlacedBlock> block;    // [nb]
};

}  // namespace talus
