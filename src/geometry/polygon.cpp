#include "geometry/polygon.hpp"

#include <algorithm>
#include <limits>

namespace talus {
namespace {

std::size_t after(std::size_t i, PolygonView polygon) { return i + 1 < polygon.size() ? i + 1 : 0; }

/// Calls f(p, q) for every edge with its ends measured from `from`.
template <class F>
void for_edges(PolygonView polygon, const Vec2& from, F f) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec2 p = polygon[i] - from;
        const Vec2 q = polygon[after(i, polygon)] - from;
        f(p, q);
    }
}

/// Twice the area of the triangle abc, positive if counter-clockwise.
double turn(const Vec2& a, const Vec2& b, const Vec2& c) { return cross(b - a, c - a); }

bool in_box_of(const Vec2& a, const Vec2& b, const Vec2& p) {
    return std::min(a.x(), b.x()) <= p.x() && p.x() <= std::max(a.x(), b.x()) && std::min(a.y(), b.y()) <= p.y() &&
           p.y() <= std::max(a.y(), b.y());
}

bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    const double abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
    if (((abc > 0) != (abd > 0)) && ((cda > 0) != (cdb > 0)) && abc != 0 && abd != 0 && cda != 0 && cdb != 0) return true;
    return (abc == 0 && in_box_of(a, b, c)) || (abd == 0 && in_box_of(a, b, d)) || (cda == 0 && in_box_of(c, d, a)) ||
           (cdb == 0 && in_box_of(c, d, b));
}

bool boxes_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    return std::max(a.x(), b.x()) >= std::min(c.x(), d.x()) && std::max(c.x(), d.x()) >= std::min(a.x(), b.x()) &&
           std::max(a.y(), b.y()) >= std::min(c.y(), d.y()) && std::max(c.y(), d.y()) >= std::min(a.y(), b.y());
}

/// Largest distance by which one edge of `a` keeps all of `b` on its outer side; negative if none does.
double separation(PolygonView a, PolygonView b) {
    double best = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < a.size(); ++i) {
        const Vec2 outward = -perp(a[after(i, a)] - a[i]).normalized();
        double nearest = std::numeric_limits<double>::infinity();
        for (const Vec2& corner : b) nearest = std::min(nearest, outward.dot(corner - a[i]));
        best = std::max(best, nearest);
    }
    return best;
}

/// One pass of without_straight_corners: each corner is judged between the last one kept and the next one.
Polygon straightened(PolygonView polygon, double tolerance) {
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec2& before = kept.empty() ? polygon.back() : kept.back();
        const Vec2& next = i + 1 < polygon.size() || kept.empty() ? polygon[after(i, polygon)] : kept.front();
        const Vec2 in = polygon[i] - before;
        const Vec2 out = next - polygon[i];
        const bool straight = std::abs(cross(in, out)) <= tolerance * (in + out).norm();
        if (!straight && in.norm() > tolerance) kept.push_back(polygon[i]);
    }
    return kept;
}

}  // namespace

Box bounds(PolygonView polygon) {
    const double inf = std::numeric_limits<double>::infinity();
    Box box{inf, inf, -inf, -inf};
    for (const Vec2& p : polygon)
        box = {std::min(box.xmin, p.x()), std::min(box.ymin, p.y()), std::max(box.xmax, p.x()), std::max(box.ymax, p.y())};
    return box;
}

double signed_area(PolygonView polygon) {
    double twice = 0.0;
    if (!polygon.empty()) for_edges(polygon, polygon[0], [&](const Vec2& p, const Vec2& q) { twice += cross(p, q); });
    return twice / 2.0;
}

double perimeter(PolygonView polygon) {
    double sum = 0.0;
    if (!polygon.empty()) for_edges(polygon, polygon[0], [&](const Vec2& p, const Vec2& q) { sum += (q - p).norm(); });
    return sum;
}

Vec2 centroid(PolygonView polygon) {
    double six_areas = 0.0;
    Vec2 moment = Vec2::Zero(), mean = Vec2::Zero();
    for_edges(polygon, polygon[0], [&](const Vec2& p, const Vec2& q) {
        six_areas += 3.0 * cross(p, q);
        moment += cross(p, q) * (p + q);
        mean += p / static_cast<double>(polygon.size());
    });
    return polygon[0] + (six_areas != 0.0 ? Vec2(moment / six_areas) : mean);
}

double polar_moment(PolygonView polygon) {
    double sum = 0.0;
    for_edges(polygon, centroid(polygon),
              [&](const Vec2& p, const Vec2& q) { sum += cross(p, q) * (p.dot(p) + p.dot(q) + q.dot(q)); });
    return sum / 12.0;
}

double rounding(PolygonView polygon) {
    double largest = 0.0;
    for (const Vec2& p : polygon) largest = std::max(largest, p.cwiseAbs().maxCoeff());
    return 4.0 * std::numeric_limits<double>::epsilon() * largest;  // three corners, each half a unit off along x and y
}

std::optional<std::pair<int, int>> crossing_edges(PolygonView polygon) {
    const std::size_t n = polygon.size();
    for (std::size_t i = 0; i < n; ++i) {
        const Vec2 &a = polygon[i], &b = polygon[after(i, polygon)];
        const Vec2& next = polygon[after(after(i, polygon), polygon)];
        if (cross(b - a, next - b) == 0.0 && (b - a).dot(next - b) <= 0.0)
            return std::pair(static_cast<int>(i), static_cast<int>(after(i, polygon)));
        for (std::size_t j = i + 2; j < n; ++j) {
            const Vec2 &c = polygon[j], &d = polygon[after(j, polygon)];
            const bool neighbours = after(j, polygon) == i;
            if (!neighbours && boxes_meet(a, b, c, d) && segments_meet(a, b, c, d))
                return std::pair(static_cast<int>(i), static_cast<int>(j));
        }
    }
    return std::nullopt;
}

bool is_convex(PolygonView polygon) {
    const double tolerance = rounding(polygon);
    double turned = 0.0;  // a star also turns left at every corner, but twice around
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const std::size_t j = after(i, polygon);
        const Vec2 in = polygon[j] - polygon[i];
        const Vec2 out = polygon[after(j, polygon)] - polygon[j];
        if (cross(in, out) < -tolerance * (in + out).norm()) return false;
        turned += std::atan2(cross(in, out), in.dot(out));
    }
    return polygon.size() >= 3 && turned < 3.0 * std::numbers::pi && signed_area(polygon) > 0.0;
}

Polygon without_straight_corners(PolygonView polygon) {
    const double tolerance = rounding(polygon);
    Polygon result(polygon.begin(), polygon.end());
    for (std::size_t before = 0; before != result.size() && result.size() >= 3;) {
        before = result.size();
        result = straightened(result, tolerance);
    }
    return result;
}

bool contains(PolygonView polygon, const Vec2& point) {
    bool inside = false;
    for_edges(polygon, point, [&](const Vec2& p, const Vec2& q) {
        // The ray to the right crosses the edge: q is above it, p is not, and the point lies on the left (or the reverse).
        if ((p.y() > 0.0) != (q.y() > 0.0) && (cross(p, q) > 0.0) == (q.y() > p.y())) inside = !inside;
    });
    return inside;
}

double smallest_width(PolygonView convex) {
    double width = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < convex.size(); ++i) {  // the narrowest strip has one edge along it
        const Vec2 inward = perp(convex[after(i, convex)] - convex[i]).normalized();
        double nearest = 0.0, farthest = 0.0;  // both, for a corner may stand out by rounding
        for (const Vec2& corner : convex) {
            const double distance = inward.dot(corner - convex[i]);
            nearest = std::min(nearest, distance);
            farthest = std::max(farthest, distance);
        }
        width = std::min(width, farthest - nearest);
    }
    return width;
}

double overlap_depth(PolygonView a, PolygonView b) { return -std::max(separation(a, b), separation(b, a)); }

std::vector<std::pair<Vec2, Vec2>> pieces_inside(PolygonView polygon, const Vec2& from, const Vec2& to) {
    const Vec2 along = to - from;
    std::vector<double> cuts{0.0, 1.0};
    for_edges(polygon, from, [&](const Vec2& p, const Vec2& q) {
        const double denominator = cross(along, q - p);
        const double t = cross(p, q - p) / denominator, s = cross(p, along) / denominator;
        if (denominator != 0.0 && t > 0.0 && t < 1.0 && s >= 0.0 && s <= 1.0) cuts.push_back(t);
    });
    std::sort(cuts.begin(), cuts.end());
    std::vector<std::pair<Vec2, Vec2>> pieces;
    double end = -1.0;  // of the last piece: pieces that follow each other are one
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        if (cuts[i] == cuts[i + 1] || !contains(polygon, from + (cuts[i] + cuts[i + 1]) / 2.0 * along)) continue;
        const Vec2 stop = cuts[i + 1] == 1.0 ? to : Vec2(from + cuts[i + 1] * along);
        if (cuts[i] == end)
            pieces.back().second = stop;
        else
            pieces.emplace_back(from + cuts[i] * along, stop);
        end = cuts[i + 1];
    }
    return pieces;
}

}  // namespace talus
