#include "scenario/outline.hpp"

#include "core/text.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

std::string edge_name(std::size_t i, std::size_t n) {
    return "edge [" + std::to_string(i) + "]-[" + std::to_string((i + 1) % n) + "]";
}

int side(const Vec2& a, const Vec2& b, const Vec2& c) {
    const double area = cross(b - a, c - a);
    return (area > 0.0) - (area < 0.0);
}

bool on_segment(const Vec2& a, const Vec2& b, const Vec2& c) {  // c is on the line through a and b
    return (c - a).dot(c - b) <= 0.0;
}

bool meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    const int c_side = side(a, b, c), d_side = side(a, b, d), a_side = side(c, d, a), b_side = side(c, d, b);
    if (c_side * d_side < 0 && a_side * b_side < 0) return true;
    return (c_side == 0 && on_segment(a, b, c)) || (d_side == 0 && on_segment(a, b, d)) ||
           (a_side == 0 && on_segment(c, d, a)) || (b_side == 0 && on_segment(c, d, b));
}

Vec2 meeting_point(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    const double parallel = cross(b - a, d - c);
    if (parallel == 0.0) return on_segment(a, b, c) ? c : d;
    return a + cross(c - a, d - c) / parallel * (b - a);
}

// All corners on one line, but for rounding, which leaves areas of about 1e-16 of the square of the size.
bool is_flat(const Polygon& corners) {
    const Vec2& first = corners.front();
    Vec2 reach = Vec2::Zero();
    for (const Vec2& corner : corners)
        if ((corner - first).norm() > reach.norm()) reach = corner - first;
    return std::all_of(corners.begin(), corners.end(), [&](const Vec2& corner) {
        return std::abs(cross(reach, corner - first)) <= 1e-14 * reach.squaredNorm();
    });
}

}  // namespace

double outline_area(const Polygon& corners) {
    double twice = 0.0;
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        twice += cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
    return twice / 2.0;
}

std::string outline_problem(const Polygon& corners, const Vec2& origin) {
    const std::size_t n = corners.size();
    if (n < 3) return "has " + std::to_string(n) + " different corners; an outline needs at least 3";
    for (std::size_t i = 0; i < n; ++i)
        if (corners[i] == corners[(i + 1) % n])
            return "corner [" + std::to_string((i + 1) % n) + "] repeats corner [" + std::to_string(i) + "] at " +
                   place(corners[i] + origin);
    if (is_flat(corners)) return "has no area";
    for (std::size_t i = 0; i < n; ++i) {
        const Vec2 &a = corners[i], &b = corners[(i + 1) % n], &c = corners[(i + 2) % n];
        if (side(a, b, c) == 0 && (b - a).dot(c - b) < 0.0)
            return edge_name(i, n) + " and " + edge_name((i + 1) % n, n) + " fold back on each other";
        for (std::size_t j = i + 2; j < n; ++j)
            if ((j + 1) % n != i && meet(a, b, corners[j], corners[(j + 1) % n]))
                return edge_name(i, n) + " meets " + edge_name(j, n) + " at " +
                       place(meeting_point(a, b, corners[j], corners[(j + 1) % n]) + origin);
    }
    return "";
}

Polygon circle_outline(const Vec2& center, double radius, int sides) {
    Polygon corners;
    for (int i = 0; i < sides; ++i) {
        const double angle = radians(360.0 * i / sides);
        corners.push_back(center + radius * Vec2(std::cos(angle), std::sin(angle)));
    }
    return corners;
}

Polygon as_outline(Polygon corners, const Cursor& at) {
    if (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
    if (const std::string problem = outline_problem(corners, at.reading().origin); !problem.empty()) {
        at.fault(problem);
        return {};
    }
    // The first corner stays the first, so that names like "corner 0" mean the same to the author.
    if (outline_area(corners) < 0.0) std::reverse(corners.begin() + 1, corners.end());
    return corners;
}

Polygon read_outline_at(const Cursor& at) { return at.given() ? as_outline(at.points(), at) : Polygon{}; }

Polygon read_circle_at(const Cursor& at) {
    if (!at["center"].given() || !at["radius"].given() || !at["sides"].given()) return {};
    return circle_outline(at["center"].point(), at["radius"].number(), static_cast<int>(at["sides"].number()));
}

Polygon read_region_at(const Cursor& at) {
    return at.is(Value::Kind::map) ? read_circle_at(at["circle"]) : read_outline_at(at);
}

}  // namespace talus
