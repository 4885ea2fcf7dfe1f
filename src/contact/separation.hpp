// Are two convex parts apart, and along which edge? The cheap answer for the many pairs that only meet at a corner.
#pragma once

#include "contact/placed_part.hpp"

#include <algorithm>

namespace talus {

/// m, distance of the nearest corner of `other` (shifted by (dx, dy) against `shape`) from the line of edge k of `shape`;
/// >= 0: the edge separates the two.
inline double separation_by_edge(const PlacedPart& shape, int k, const PlacedPart& other, double dx, double dy) {
    const double nx = shape.normal(k).x(), ny = shape.normal(k).y();
    double nearest = nx * other.arm(0).x() + ny * other.arm(0).y();
    for (int i = 1; i < other.n; ++i) nearest = std::min(nearest, nx * other.arm(i).x() + ny * other.arm(i).y());
    return nearest + (nx * dx + ny * dy) - shape.offset[k];
}

struct Separation {
    double distance = -1e300;  // m, largest over all edges; >= 0 apart; < 0 least depth
    int edge = -1;             // local index, of a if `of_a`, else of b
    bool of_a = true;
};

/// Separating-axis test over all edges that bound the blocks or their parts; the centroid of b lies at (dx, dy) from that of
/// a. Whether the result is >= 0 does not depend on the order in which edges are tried.
Separation separation(const PlacedPart& a, const PlacedPart& b, double dx, double dy);

/// Edge of `other` that faces the direction (nx, ny) most squarely against it (its normal is nearest to -n).
int facing_edge(const PlacedPart& other, double nx, double ny);

}  // namespace talus
