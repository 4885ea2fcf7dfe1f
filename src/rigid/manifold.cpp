#include "rigid/manifold.hpp"

#include "contact/separation.hpp"

#include <algorithm>
#include <limits>

namespace talus::rigid {
namespace {

// Of two faces that keep apart equally well that of a counts, or rounding would decide, and turn the normal to and fro.
// m; half or twice of it is as good: far above rounding, far below any distance that matters.
constexpr double tie = 1e-9;

// A corner whose edges both leave the face by more than this (sine) is a tip; less, and it is an edge along the face.
constexpr double pointed = 1e-3;

// Stretches that count as none: how deep a tip may be in the wall of a notch and still be met by it.
constexpr double sunk = 10.0;

struct BestEdge {
    double distance = -std::numeric_limits<double>::infinity();
    int edge = -1;
    double of_any = -std::numeric_limits<double>::infinity();  // inner edges too
};

/// Looks at every edge; false if one of them keeps the two further apart than `reach` (`edge` is that one then).
bool look(const PlacedPart& shape, const PlacedPart& other, double dx, double dy, double reach, BestEdge& best) {
    for (int k = 0; k < shape.n; ++k) {
        const double distance = separation_by_edge(shape, k, other, dx, dy);
        if (distance > reach) {
            best.edge = k;
            return false;
        }
        best.of_any = std::max(best.of_any, distance);
        if (!shape.internal[k] && distance > best.distance) best.distance = distance, best.edge = k;
    }
    return true;
}

/// The outer edge that faces n most squarely.
int opposite_edge(const PlacedPart& other, const Vec2& n) {
    int found = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < other.n; ++k) {
        const double cosine = other.normal(k).dot(n);
        if (!other.internal[k] && cosine < least) least = cosine, found = k;
    }
    return found;
}

/// Edge k of `face` against `other`; `to_other` leads from the centroid of the first to that of the second.
Manifold along_face(const PlacedPart& face, int k, const PlacedPart& other, const Vec2& to_other, double reach,
                    double narrow) {
    Manifold m;
    const Vec2 &start = face.arm(k), &end = face.arm(face.next(k)), &n = face.normal(k);
    const int j = opposite_edge(other, n);
    if (j < 0) return m;
    const Vec2 t = perp(n), o0 = other.arm(other.next(j)) + to_other, o1 = other.arm(j) + to_other;  // in the order of t
    const double s0 = t.dot(o0 - start), s1 = t.dot(o1 - start), g0 = n.dot(o0 - start), g1 = n.dot(o1 - start);
    const double lo = std::max(0.0, s0), hi = std::min(t.dot(end - start), s1);
    if (!(hi - lo > narrow)) return m;
    m.normal = n;
    m.length = hi - lo;
    m.edge_a = face.first + k;
    m.edge_b = other.first + j;
    const double slope = (g1 - g0) / (s1 - s0);
    for (const double s : {lo, hi}) {
        const double gap = g0 + slope * (s - s0);
        if (gap > reach) continue;
        if (m.count == 0) m.single_low = s == lo;
        m.corner_of_b[m.count] = s == s0 || s == s1;  // of the other part
        m.gap[m.count] = gap;
        m.point[m.count++] = start + s * t + 0.5 * gap * n;
    }
    return m;
}

/// The corner of `other` that lies deepest behind edge k of `face`; -1 if it is no tip, no corner of its block, or not in
/// front of the edge.
int tip_on_face(const PlacedPart& face, int k, const PlacedPart& other, const Vec2& to_other) {
    const Vec2 &start = face.arm(k), &n = face.normal(k);
    int tip = 0;
    for (int i = 1; i < other.n; ++i)
        if (n.dot(other.arm(i)) < n.dot(other.arm(tip))) tip = i;
    if (other.internal[tip] || other.internal[other.previous(tip)]) return -1;
    const Vec2 out = other.arm(other.next(tip)) - other.arm(tip), in = other.arm(other.previous(tip)) - other.arm(tip);
    if (n.dot(out) <= pointed * out.norm() || n.dot(in) <= pointed * in.norm()) return -1;
    const double s = perp(n).dot(other.arm(tip) + to_other - start);
    return s >= -tie && s <= face.length[k] + tie ? tip : -1;
}

/// A tip in a notch: it meets the wall in the very corner where that ends, along no stretch.
Manifold at_tip(const PlacedPart& face, int k, const PlacedPart& other, int tip, const Vec2& to_other, double reach) {
    Manifold m;
    const Vec2 place = other.arm(tip) + to_other;
    m.normal = face.normal(k);
    m.gap[0] = m.normal.dot(place - face.arm(k));
    if (m.gap[0] > reach) return m;
    m.count = 1;
    m.corner_of_b[0] = true;
    m.point[0] = place - 0.5 * m.gap[0] * m.normal;
    m.edge_a = face.first + k;
    m.edge_b = other.first + tip;
    return m;
}

double cosine_of_corner(const PlacedPart& part, int k) { return -part.normal(part.previous(k)).dot(part.normal(k)); }

/// The outer edge that the other part came through last, of those that kept the two apart at the start; `best.distance` is
/// that time, in s before now, negative.
void look_back(const PlacedPart& face, const PlacedPart& other, const Vec2& to_other, const Velocity& mine,
               const Velocity& its, double since, BestEdge& best) {
    for (int k = 0; k < face.n; ++k) {
        if (face.internal[k]) continue;
        const Vec2& n = face.normal(k);
        double now = std::numeric_limits<double>::infinity(), then = now;
        for (int i = 0; i < other.n; ++i) {
            const Vec2 arm = other.arm(i), place = arm + to_other;
            const double gap = n.dot(place - face.arm(k));
            const Vec2 speed = Vec2(its.x - mine.x, its.y - mine.y) + its.spin * perp(arm) - mine.spin * perp(place);
            now = std::min(now, gap);
            then = std::min(then, gap - since * n.dot(speed));
        }
        if (now >= 0.0 || then < 0.0) continue;
        const double met = -since * now / (now - then);  // then > 0 > now
        if (met > best.distance) best.distance = met, best.edge = k;
    }
}

/// A manifold of b and a as one of a and b.
Manifold seen_from_a(Manifold m, const Vec2& d) {
    m.normal = -m.normal;
    m.face_of_b = true;
    for (bool& corner : m.corner_of_b) corner = !corner;
    std::swap(m.edge_a, m.edge_b);
    m.single_low = !m.single_low;
    for (Vec2& p : m.point) p += d;  // half-way between both parts, seen from a
    if (m.count == 2) {
        std::swap(m.point[0], m.point[1]);
        std::swap(m.gap[0], m.gap[1]);
        std::swap(m.corner_of_b[0], m.corner_of_b[1]);
    }
    return m;
}

/// Of two corners that meet the sharper one is the tip.
Manifold meet_at_tip(const PlacedPart& a, int edge_a, const PlacedPart& b, int edge_b, const Vec2& d, double reach) {
    const int tip_of_b = tip_on_face(a, edge_a, b, d), tip_of_a = tip_on_face(b, edge_b, a, -d);
    if (tip_of_a >= 0 && (tip_of_b < 0 || cosine_of_corner(a, tip_of_a) > cosine_of_corner(b, tip_of_b) + tie))
        return seen_from_a(at_tip(b, edge_b, a, tip_of_a, -d, reach), d);
    return tip_of_b >= 0 ? at_tip(a, edge_a, b, tip_of_b, d, reach) : Manifold{};
}

}  // namespace

Manifold find_manifold(const PlacedPart& a, const PlacedPart& b, const Vec2& d, double reach, double narrow, int& hint) {
    if (hint >= 0) {
        const double distance =
            hint < a.n ? separation_by_edge(a, hint, b, d.x(), d.y()) : separation_by_edge(b, hint - a.n, a, -d.x(), -d.y());
        if (distance > reach) return {};
    }
    BestEdge of_a, of_b;
    if (!look(a, b, d.x(), d.y(), reach, of_a)) {
        hint = of_a.edge;
        return {};
    }
    if (!look(b, a, -d.x(), -d.y(), reach, of_b)) {
        hint = a.n + of_b.edge;
        return {};
    }
    hint = -1;
    Manifold m;
    const double distance = std::max(of_a.of_any, of_b.of_any);
    if (of_a.edge < 0 || of_b.edge < 0) {  // a part inside its block
        m.distance = distance;
        return m;
    }
    const auto along = [&](bool of_first) {
        return of_first ? along_face(a, of_a.edge, b, d, reach, narrow)
                        : seen_from_a(along_face(b, of_b.edge, a, -d, reach, narrow), d);
    };
    // What hardly reaches over an inner edge is carried by the part on the other side of it; the outer faces of this one may
    // lie on the far side of the block.
    const double outer = std::max(of_a.distance, of_b.distance);
    if (outer < distance - tie && outer < -sunk * narrow) {
        m.distance = distance;
        return m;
    }
    const bool first = of_a.distance >= of_b.distance - tie;
    m = along(first);
    if (m.length == 0.0 && std::min(of_a.distance, of_b.distance) >= -sunk * narrow) {
        m = along(!first);
        if (m.length == 0.0) m = meet_at_tip(a, of_a.edge, b, of_b.edge, d, reach);
    }
    m.distance = distance;
    return m;
}

Manifold find_manifold(const PlacedPart& a, const PlacedPart& b, const Vec2& d, double reach, double narrow,
                       const OnTheWay& way) {
    BestEdge of_a, of_b;  // by the time before the middle at which they met, negative
    look_back(a, b, d, way.a, way.b, way.since, of_a);
    look_back(b, a, -d, way.b, way.a, way.since, of_b);
    if (of_a.edge < 0 && of_b.edge < 0) return {};
    return of_a.distance >= of_b.distance ? along_face(a, of_a.edge, b, d, reach, narrow)
                                          : seen_from_a(along_face(b, of_b.edge, a, -d, reach, narrow), d);
}

}  // namespace talus::rigid
