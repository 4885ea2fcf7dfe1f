// Geometry turned to where the blocks are now. Scratch: made anew from Model and Motion at every step.
#pragma once

#include "core/types.hpp"

#include <vector>

namespace talus {

struct Placed {
    std::vector<Vec2> arm;     // [nc] m, corners from the centroid of their block, turned
    std::vector<Vec2> normal;  // [nc] outward unit normals of the edges, turned
};

}  // namespace talus
