#include "model/query.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace talus {
namespace {

constexpr double on_edge = 1e-9;  // m, far below any gap that matters

Vec2 turned_back(const Vec2& v, const Turn& t) { return {t.c * v.x() + t.s * v.y(), t.c * v.y() - t.s * v.x()}; }

std::vector<PartId> parts_there(const Parts& parts, std::span<const std::uint8_t> removed) {
    std::vector<PartId> there;
    for (PartId p = 0; p < parts.size(); ++p)
        if (!removed[parts.block[p]]) there.push_back(p);
    return there;
}

std::vector<Box> boxes_of(std::span<const PartId> those, const Parts& parts, const Corners& corners,
                          std::span<const Vec2> position, std::span<const Turn> turns) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    std::vector<Box> boxes;
    for (const PartId p : those) {
        Vec2 low(infinite, infinite), high(-infinite, -infinite);
        for (int k = parts.first_corner[p]; k < parts.first_corner[p + 1]; ++k) {
            const Vec2 corner = position[parts.block[p]] + turned(corners.arm[k], turns[parts.block[p]]);
            low = low.cwiseMin(corner), high = high.cwiseMax(corner);
        }
        boxes.push_back(Box{low.x(), low.y(), high.x(), high.y()}.grown(on_edge));
    }
    return boxes;
}

std::vector<Turn> turns_of(std::span<const double> angle) {
    std::vector<Turn> turns;
    for (const double a : angle) turns.push_back(turn(a));
    return turns;
}

std::vector<BlockId> sorted_once(std::vector<BlockId> blocks) {
    std::sort(blocks.begin(), blocks.end());
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    return blocks;
}

/// Keeps the shares [entry, exit] of a segment for which slope t <= bound; false if none is left.
bool cut(double slope, double bound, double& entry, double& exit) {
    if (slope == 0.0) return bound >= 0.0;
    if (slope > 0.0)
        exit = std::min(exit, bound / slope);
    else
        entry = std::max(entry, bound / slope);
    return entry <= exit;
}

/// Whether a segment meets a box.
bool crosses(const Box& box, const Vec2& from, const Vec2& step) {
    double entry = 0.0, exit = 1.0;
    return cut(step.x(), box.xmax - from.x(), entry, exit) && cut(-step.x(), from.x() - box.xmin, entry, exit) &&
           cut(step.y(), box.ymax - from.y(), entry, exit) && cut(-step.y(), from.y() - box.ymin, entry, exit);
}

}  // namespace

BlockQuery::BlockQuery(const Parts& parts, const Corners& corners, std::span<const Vec2> position,
                       std::span<const double> angle, std::span<const std::uint8_t> removed)
    : parts_(parts),
      corners_(corners),
      position_(position.begin(), position.end()),
      turn_(turns_of(angle)),
      part_(parts_there(parts, removed)),
      tree_(boxes_of(part_, parts, corners, position_, turn_)) {}

std::vector<BlockId> BlockQuery::at(const Vec2& point) const {
    std::vector<BlockId> found;
    tree_.overlapping({point.x(), point.y(), point.x(), point.y()}, [&](int i) {
        const BlockId block = parts_.block[part_[i]];
        if (holds(part_[i], seen_from(block, point))) found.push_back(block);
    });
    return sorted_once(std::move(found));
}

std::vector<BlockId> BlockQuery::in(const Box& rectangle) const {
    const Vec2 low(rectangle.xmin, rectangle.ymin), high(rectangle.xmax, rectangle.ymax);
    std::vector<BlockId> found;
    if (!(low.x() <= high.x() && low.y() <= high.y())) return found;
    tree_.overlapping(rectangle, [&](int i) {
        if (meets(part_[i], (low + high) / 2.0, (high - low) / 2.0)) found.push_back(parts_.block[part_[i]]);
    });
    return sorted_once(std::move(found));
}

std::vector<BlockQuery::Hit> BlockQuery::along(const Vec2& from, const Vec2& to) const {
    std::vector<Stretch> all;
    const Vec2 step = to - from;
    tree_.where([&](const Box& box) { return crosses(box, from, step); },
                [&](int i) {  // first without tolerance: it would make a line that grazes enter too early
                    auto found = stretch(part_[i], from, to, 0.0);
                    if (!found) found = stretch(part_[i], from, to, on_edge);
                    if (found) all.push_back(*found);
                });
    std::sort(all.begin(), all.end(),
              [](const auto& a, const auto& b) { return std::tie(a.block, a.entry) < std::tie(b.block, b.entry); });

    const double length = step.norm();
    std::vector<Hit> hits;
    for (const Stretch& s : all) {
        const double entry = s.entry * length, exit = s.exit * length;
        if (hits.empty() || hits.back().block != s.block) {
            hits.push_back({s.block, entry, exit, exit - entry});
        } else {  // another part of the same block: only what it adds
            Hit& hit = hits.back();
            hit.inside += std::max(0.0, exit - std::max(entry, hit.exit));
            hit.exit = std::max(hit.exit, exit);
        }
    }
    std::sort(hits.begin(), hits.end(),
              [](const auto& a, const auto& b) { return std::tie(a.entry, a.block) < std::tie(b.entry, b.block); });
    return hits;
}

/// A point relative to the centroid of a block, unrotated: there the edges are as the model has them.
Vec2 BlockQuery::seen_from(BlockId block, const Vec2& point) const {
    return turned_back(point - position_[block], turn_[block]);
}

bool BlockQuery::holds(PartId part, const Vec2& arm) const {
    for (int k = parts_.first_corner[part]; k < parts_.first_corner[part + 1]; ++k)
        if (!(corners_.normal[k].dot(arm) <= corners_.offset[k] + on_edge)) return false;
    return true;
}

/// Two convex shapes share a point unless an edge of one of them parts them. The edges of the rectangle have been tried: the
/// bounds of the part overlap it.
bool BlockQuery::meets(PartId part, const Vec2& centre, const Vec2& half) const {
    const BlockId block = parts_.block[part];
    const Vec2 arm = seen_from(block, centre);
    for (int k = parts_.first_corner[part]; k < parts_.first_corner[part + 1]; ++k) {
        const Vec2 normal = turned(corners_.normal[k], turn_[block]);
        const double nearest = corners_.normal[k].dot(arm) - normal.cwiseAbs().dot(half);
        if (!(nearest <= corners_.offset[k] + on_edge)) return false;
    }
    return true;
}

/// A segment is cut along every edge of the part (Cyrus & Beck 1978).
std::optional<BlockQuery::Stretch> BlockQuery::stretch(PartId part, const Vec2& from, const Vec2& to,
                                                       double tolerance) const {
    const BlockId block = parts_.block[part];
    const Vec2 arm = seen_from(block, from), step = turned_back(to - from, turn_[block]);
    Stretch found{block, 0.0, 1.0};
    for (int k = parts_.first_corner[part]; k < parts_.first_corner[part + 1]; ++k) {
        const Vec2& normal = corners_.normal[k];
        if (!cut(normal.dot(step), corners_.offset[k] + tolerance - normal.dot(arm), found.entry, found.exit))
            return std::nullopt;
    }
    return found;
}

}  // namespace talus
