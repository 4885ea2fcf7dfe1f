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
    double angle;             // rad
};

/// A vector in the frame of the axes of boxes, of which the first is given; exact if that is x.
inline Vec2 along(const Vec2& axis, const Vec2& v) {
    return {axis.x() * v.x() + axis.y() * v.y(), axis.x() * v.y() - axis.y() * v.x()};
}

/// Where a block was when it got its boxes: all that is read, in one stream, to see whether it is still in them.
struct Boxed {
    Vec2 position;  // m
    double angle;   // rad
    double radius;  // m, of the block

    /// m, no less than any point of the block has moved along one of the axes of boxes.
    double moved(const Vec2& to_position, double to_angle, const Vec2& axis) const {
        const Vec2 way = along(axis, to_position - position);
        return std::max(std::abs(way.x()), std::abs(way.y())) + std::abs(to_angle - angle) * radius;
    }
};

struct Placed {
    std::vector<PlacedCorner> corner;  // [nc]
    std::vector<PlacedBlock> block;    // [nb]
    std::vector<Boxed> boxed;          // [nb]; empty = no boxes yet
    // [nb] m, sum over all steps: no point of the block has moved further than this grew. What is decided with it holds
    // until the sum has grown by so much.
    std::vector<double> path;

    /// Adds what the block has moved since it was placed last; `radius` (m) is that of the block.
    void add_to_path(BlockId b, const Vec2& to_position, double to_angle, double radius) {
        constexpr double upwards = 1.0 + 1e-15;  // of all that rounding could have taken away
        const PlacedBlock& from = block[b];
        const double way = std::abs(to_position.x() - from.position.x()) + std::abs(to_position.y() - from.position.y());
        path[b] = (path[b] + way + std::abs(to_angle - from.angle) * radius) * upwards;
    }
};

}  // namespace talus
