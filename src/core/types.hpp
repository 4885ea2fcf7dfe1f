// Words shared by every room. SI units, plane problem of 1 m thickness, y up, angles counter-clockwise, compression
// positive.
#pragma once

#include <Eigen/Core>

#include <cmath>
#include <compare>
#include <numbers>
#include <span>
#include <vector>

namespace talus {

using Vec2 = Eigen::Vector2d;
using BlockId = int;
using PartId = int;
using Polygon = std::vector<Vec2>;  // corners in m, counter-clockwise unless said otherwise, not closed

/// Closed axis-aligned box, m: touching boxes overlap.
struct Box {
    double xmin, ymin, xmax, ymax;

    bool overlaps(const Box& o) const { return xmin <= o.xmax && o.xmin <= xmax && ymin <= o.ymax && o.ymin <= ymax; }
    bool contains(const Box& o) const { return xmin <= o.xmin && ymin <= o.ymin && xmax >= o.xmax && ymax >= o.ymax; }
    Box grown(double by) const { return {xmin - by, ymin - by, xmax + by, ymax + by}; }
};

/// Two items of a search, a < b; lists of pairs are sorted by (a, b).
struct Pair {
    int a, b;
    auto operator<=>(const Pair&) const = default;
};

inline double cross(const Vec2& u, const Vec2& v) { return u.x() * v.y() - u.y() * v.x(); }
inline Vec2 perp(const Vec2& v) { return {-v.y(), v.x()}; }  // turned by +90 degrees
inline double radians(double degrees) { return degrees * (std::numbers::pi / 180.0); }
inline double degrees(double radians) { return radians * (180.0 / std::numbers::pi); }

}  // namespace talus
