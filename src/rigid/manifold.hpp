// Where two convex parts touch or are about to: the stretch along which their faces look at each other, by its two ends.
#pragma once

#include "contact/placed_part.hpp"
#include "rigid/impulses.hpp"

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
    bool face_of_b = false;        // the face that keeps the two apart
    bool corner_of_b[2] = {};      // the corner at this end, on or above the other part
    int edge_a = -1, edge_b = -1;  // corners (global) where the two edges start
    double distance = 0.0;         // m, between the two parts, < 0: how deep they lie in each other; known when within reach
};

/// What is closer than `reach` (m); the centroid of b lies at d from that of a. `narrow` (m): a stretch shorter than this is
/// none, or two corners that pass each other would hold each other back. `hint`: an edge that kept the two apart when they
/// were looked at last, 0..n_a-1 of a, then those of b, -1 = not known; it saves time and cannot change the answer.
Manifold find_manifold(const PlacedPart& a, const PlacedPart& b, const Vec2& d, double reach, double narrow, int& hint);

/// Two parts on their way, each turning about the centroid of its block.
struct OnTheWay {
    Velocity a, b;
    double since;  // s, start of the step
};

/// Of parts that have come into each other since then: the face that kept them apart longest, not the one that would part
/// them soonest now; so that what flies at the edge of a wall does not slip over it. No ends if none kept them apart then.
Manifold find_manifold(const PlacedPart& a, const PlacedPart& b, const Vec2& d, double reach, double narrow,
                       const OnTheWay& way);

}  // namespace talus::rigid
