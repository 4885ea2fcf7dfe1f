// Measures of polygons. All of them count from a corner nearby, so that a polygon far from the origin loses no digits.
#pragma once

#include "core/types.hpp"

#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace talus {

using PolygonView = std::span<const Vec2>;  // corners in m, not closed; any polygon of this page may be given as one

Box bounds(PolygonView polygon);
double signed_area(PolygonView polygon);   // m2, positive if counter-clockwise
double perimeter(PolygonView polygon);     // m
Vec2 centroid(PolygonView polygon);        // m, of the area; the mean of the corners if there is no area
double polar_moment(PolygonView polygon);  // m4, integral of r^2 about the centroid; x density = inertia per m thickness

/// Distance below which coordinates of this size cannot tell a corner from a straight edge, m.
double rounding(PolygonView polygon);

/// Two edges (corner indices where they start) that cross, touch or fold back on each other; nothing if the polygon is
/// simple. An edge without length counts as crossing the next one.
std::optional<std::pair<int, int>> crossing_edges(PolygonView polygon);
inline bool is_simple(PolygonView polygon) { return polygon.size() >= 3 && !crossing_edges(polygon); }

/// Counter-clockwise and without a corner that bends inwards by more than rounding.
bool is_convex(PolygonView polygon);

/// The polygon without corners that are straight to rounding (or doubled); fewer than 3 corners if nothing is left.
Polygon without_straight_corners(PolygonView polygon);

/// Simple polygon of either orientation; points on the boundary belong to one side or the other.
bool contains(PolygonView polygon, const Vec2& point);

/// Smallest distance between two parallel lines that have a convex polygon between them, m.
double smallest_width(PolygonView convex);

/// How deep two convex polygons (counter-clockwise) overlap: the shortest move that parts them, m. Negative if they are
/// apart: then a lower bound of the distance.
double overlap_depth(PolygonView a, PolygonView b);

/// Pieces of a segment inside a simple polygon, from `from` to `to`.
std::vector<std::pair<Vec2, Vec2>> pieces_inside(PolygonView polygon, const Vec2& from, const Vec2& to);

}  // namespace talus
