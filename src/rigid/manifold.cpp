#include "rigid/manifold.hpp"

#include "contact/separation.hpp"

#include <algorithm>
#include <limits>

namespace talus::rigid {
namespace {

// Of two faces that keep apart equally well that of a counts, or rounding would decide, and turn the normal to and fro.
// m; half or twice of it is as good: far above rounding, far below any distance that matters.
constexpr double tie = 1e-9;

struct BestEdge {
    double distance = -std::numeric_limits<double>::infinity();
    int edge = -1;
};

/// Looks at every edge; false if one of them keeps the two further apart than `reach` (`edge` is that one then).
bool look(const PlacedPart& shape, const PlacedPart& other, double dx, double dy, double reach, BestEdge& best) {
    for (int k = 0; k < shape.n; ++k) {
        const double distance = separation_by_edge(shape, k, other, dx, dy);
        if (distance > reach) {
            best.edge = k;
            return false;
        }
        if (!shape.internal[k] && distance > best.distance) best = {distance, k};
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
        m.gap[m.count] = gap;
        m.point[m.count++] = start + s * t + 0.5 * gap * n;
    }
    return m;
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
    if (of_a.edge < 0 || of_b.edge < 0) return {};  // a part inside its block
    if (of_a.distance >= of_b.distance - tie) return along_face(a, of_a.edge, b, d, reach, narrow);
    Manifold m = along_face(b, of_b.edge, a, -d, reach, narrow);
    m.normal = -m.normal;
    std::swap(m.edge_a, m.edge_b);
    m.single_low = !m.single_low;
    for (Vec2& p : m.point) p += d;  // half-way between both parts, seen from a
    if (m.count == 2) {
        std::swap(m.point[0], m.point[1]);
        std::swap(m.gap[0], m.gap[1]);
    }
    return m;
}

}  // namespace talus::rigid
