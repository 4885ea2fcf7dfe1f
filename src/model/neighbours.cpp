#include "model/neighbours.hpp"

#include "geometry/box_tree.hpp"
#include "geometry/polygon.hpp"

#include <algorithm>
#include <optional>
#include <tuple>

namespace talus {
namespace {

// A common stretch shorter than this share of the shorter edge is the rounding of two corners that meet.
constexpr double shortest_stretch = 1e-6;

struct Scan {
    const Model& model;
    std::span<const Vec2> corner;
    double tolerance;

    std::span<const Vec2> polygon(PartId p) const {
        const int first = model.parts.first_corner[p];
        return corner.subspan(first, model.parts.first_corner[p + 1] - first);
    }

    // Common stretch of edge i of one part and edge j of another, if they face each other on one line.
    std::optional<Neighbours::Touch> stretch(PartId a, PartId b, int i, int j, int j_next) const {
        const Vec2& n = model.corners.normal[i];
        if (n.dot(model.corners.normal[j]) > -0.5) return std::nullopt;
        const Vec2 along = perp(n), first = corner[j_next] - corner[i], last = corner[j] - corner[i];
        const double f = along.dot(first), l = along.dot(last);
        const double s0 = std::max(f, 0.0), s1 = std::min(l, model.corners.length[i]);
        if (s1 - s0 <= shortest_stretch * std::min(model.corners.length[i], model.corners.length[j])) return std::nullopt;
        const auto gap = [&](double s) { return n.dot(first) + (s - f) / (l - f) * n.dot(last - first); };
        if (std::abs(gap(s0)) > tolerance || std::abs(gap(s1)) > tolerance) return std::nullopt;
        return Neighbours::Touch{a, b, i, j, s0, s1};
    }

    std::optional<Neighbours::Touch> touch(PartId a, PartId b) const {
        std::optional<Neighbours::Touch> longest;
        const std::vector<int>& first = model.parts.first_corner;
        for (int i = first[a]; i < first[a + 1]; ++i)
            for (int j = first[b]; j < first[b + 1]; ++j) {
                const auto found = stretch(a, b, i, j, j + 1 < first[b + 1] ? j + 1 : first[b]);
                if (found && (!longest || found->s1 - found->s0 > longest->s1 - longest->s0)) longest = found;
            }
        return longest;
    }
};

// What two convex polygons share: the first is cut along every edge of the second (Sutherland & Hodgman 1974).
Polygon common_area(std::span<const Vec2> a, std::span<const Vec2> b) {
    Polygon common(a.begin(), a.end());
    for (std::size_t k = 0; k < b.size(); ++k) {
        const Vec2 edge = b[(k + 1) % b.size()] - b[k];
        Polygon kept;
        for (std::size_t i = 0; i < common.size(); ++i) {
            const Vec2 &p = common[i], &q = common[(i + 1) % common.size()];
            const double at_p = cross(edge, p - b[k]), at_q = cross(edge, q - b[k]);
            if (at_p >= 0.0) kept.push_back(p);
            if ((at_p < 0.0) != (at_q < 0.0)) kept.push_back(p + at_p / (at_p - at_q) * (q - p));
        }
        common = std::move(kept);
    }
    return common;
}

void keep_deepest(std::vector<Neighbours::Overlap>& overlaps) {
    std::sort(overlaps.begin(), overlaps.end(),
              [](const auto& x, const auto& y) { return std::tie(x.a, x.b, y.depth) < std::tie(y.a, y.b, x.depth); });
    const auto same = [](const auto& x, const auto& y) { return x.a == y.a && x.b == y.b; };
    overlaps.erase(std::unique(overlaps.begin(), overlaps.end(), same), overlaps.end());
}

}  // namespace

Neighbours find_neighbours(const Model& model, std::span<const Vec2> corner, double tolerance) {
    const Scan scan{model, corner, tolerance};
    std::vector<Box> boxes(model.parts.size());
    for (PartId p = 0; p < model.parts.size(); ++p) boxes[p] = bounds(scan.polygon(p)).grown(tolerance);
    const BoxTree tree(boxes);

    Neighbours all;
    all.covered.assign(model.corners.size(), 0);
    std::vector<PartId> near;
    for (PartId a = 0; a < model.parts.size(); ++a) {
        near.clear();
        tree.overlapping(boxes[a], [&](PartId b) {
            if (model.parts.block[b] > model.parts.block[a]) near.push_back(b);
        });
        std::sort(near.begin(), near.end());
        for (const PartId b : near) {
            const double depth = overlap_depth(scan.polygon(a), scan.polygon(b));
            if (depth < -tolerance) continue;
            if (depth > tolerance) {
                const Vec2 at = centroid(common_area(scan.polygon(a), scan.polygon(b)));
                all.overlaps.push_back({model.parts.block[a], model.parts.block[b], depth, at});
            } else if (const auto touch = scan.touch(a, b)) {
                all.touches.push_back(*touch);
                all.covered[touch->edge_a] = all.covered[touch->edge_b] = 1;
            }
        }
    }
    keep_deepest(all.overlaps);
    return all;
}

}  // namespace talus
