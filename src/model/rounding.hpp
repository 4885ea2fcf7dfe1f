// How much of each corner is rounded off, for contacts at points.
#pragma once

#include "model/model.hpp"

namespace talus {

/// An arc that leaves both edges of a corner at `cut` from its tip.
struct CornerArc {
    double cut, radius;  // m
};

/// `before`, `after`: unit normals of the edges that end and start at the corner.
CornerArc corner_arc(const Vec2& before, const Vec2& after, double cut);

/// [nc] m, where the arc of each corner leaves its edges: `length` from the tip, or less where an edge is shorter than twice
/// that, or where the whole circle would not fit into the block. For convex blocks.
std::vector<double> corner_cuts(const Model& model, double length);

}  // namespace talus
