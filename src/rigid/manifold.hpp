// Where two convex parts touch or are about to: the stretch along which their faces look at each other, by its two ends.
#pragma once

#include "contact/placed_part.hpp"

namespace talus::rigid {

/// A straight stretch between two parts. What a rigid face carries is fixed by the forces at both ends of it; a corner on a
/// face has one end only, the other being too far away to count.
struct Manifold {
    int count = 0;                 // ends that are near: 0, 1 or 2; in the order of perp(normal)
    Vec2 normal = Vec2::Zero();    // unit, from a to b: that of the face that keeps the two apart
    Vec2 point[2];                 // m, from the centroid of block a, half-way between both parts
    double gap[2] = {0.0, 0.0};    // m, < 0 overlap
    double length = 0.0;           // m, of the whole stretch
    bool single_low = false;       // of one end: whether it is the first along perp(normal)
    int edge_a = -1, edge_b = -1;  // corners (global) where the two edges start
};

/// What is closer than `reach` (m); the centroid of b lies at d from that of a. `narrow` (m): a stretch shorter than this is
/// none, or two corners that pass each other would hold each other back. `hint`: an edge that kept the two apart when they
/// were looked at last, 0..n_a-1 of a, then those of b, -1 = not known; it saves time and cannot change the answer.
Manifold find_manifold(const PlacedPart& a, const PlacedPart& b, const Vec2& d, double reach, double narrow, int& hint);

}  // namespace talus::rigid
