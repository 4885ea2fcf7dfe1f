// Geometry turned to where the blocks are now. Scratch: made anew from Model and Motion at every step, and laid out so that
// what a contact reads lies together.
#pragma once

#include "core/types.hpp"

#include <algorithm>
#include <cmath>
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

/// Where a block was when it got its boxes: all that is read, in one stream, to see whether it is still in them.
struct Boxed {
    Vec2 position;  // m
    double angle;   // rad
    double radius;  // m, of the block

    /// m, no less than any point of the block has moved along x or y.
    double moved(const Vec2& to_position, double to_angle) const {
        const double x = std::abs(to_position.x() - position.x()), y = std::abs(to_position.y() - position.y());
        return std::max(x, y) + std::abs(to_angle - angle) * radius;
    }
};

struct Placed {
    std::vector<PlacedCorner> corner;  // [nc]
    std::vector<PlacedBlock> block;    // [nb]
    std::vector<Boxed> boxed;          // [nb]; empty = no boxes yet
};

}  // namespace talus
