#include "geometry/planar_map.hpp"
#include "geometry/polygon.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace talus {
namespace {

/// Place of a point along a Hilbert curve over a square grid of 2^16 x 2^16 cells.
std::uint64_t hilbert(std::uint32_t x, std::uint32_t y) {
    std::uint64_t place = 0;
    for (std::uint32_t side = 1u << 15; side > 0; side /= 2) {
        const std::uint32_t right = (x & side) ? 1 : 0, up = (y & side) ? 1 : 0;
        place += static_cast<std::uint64_t>(side) * side * ((3 * right) ^ up);
        if (up == 0) {  // turn the quadrant so that the curve goes on where it left the last one
            if (right == 1) x = ~x, y = ~y;
            std::swap(x, y);
        }
    }
    return place;
}

/// Closed paths around the blocks, cut into simple loops of vertices.
class Tracer {
public:
    Tracer(const PlanarMap& map, const std::vector<int>& of)
        : map_(map), of_(of), seen_(map.half.size(), false), place_(map.point.size(), -1) {}

    int block(int h) const { return map_.half[h].face < 0 ? -1 : of_[map_.half[h].face]; }
    bool is_border(int h) const { return block(h) >= 0 && block(h) != block(h ^ 1); }
    bool seen(int h) const { return seen_[h]; }

    /// Loops of the path that starts with this edge. It may touch itself at a vertex, where it is cut into several.
    std::vector<std::vector<int>> loops(int first) {
        std::vector<std::vector<int>> result;
        std::vector<int> path;
        for (int h = first; !seen_[h]; h = next(h)) {
            seen_[h] = true;
            const int vertex = map_.half[h].from;
            if (place_[vertex] >= 0) result.push_back(cut_off(path, place_[vertex]));
            place_[vertex] = static_cast<int>(path.size());
            path.push_back(h);
        }
        result.push_back(cut_off(path, 0));
        return result;
    }

private:
    int next(int h) const {  // turning around the end vertex over edges that lie inside the block
        int n = map_.half[h].next;
        while (!is_border(n)) n = map_.half[n ^ 1].next;
        return n;
    }

    std::vector<int> cut_off(std::vector<int>& path, int from) {
        std::vector<int> loop(path.begin() + from, path.end());
        path.resize(from);
        for (const int h : loop) place_[map_.half[h].from] = -1;
        return loop;
    }

    const PlanarMap& map_;
    const std::vector<int>& of_;
    std::vector<char> seen_;
    std::vector<int> place_;  // [nv] place of a vertex in the path, -1 if it is not on it
};

Polygon corners(const PlanarMap& map, const std::vector<int>& loop) {
    Polygon polygon;
    for (const int h : loop) polygon.push_back(map.start(h));
    return without_straight_corners(polygon);
}

/// Order of the blocks along the curve.
std::vector<int> order_of(const std::vector<CutBlock>& blocks, const Box& box) {
    const double cell = std::max({box.xmax - box.xmin, box.ymax - box.ymin, 1e-300}) / 65535.0;
    std::vector<std::uint64_t> place(blocks.size());
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        const Vec2 at = (centroid(blocks[b].outline) - Vec2(box.xmin, box.ymin)) / cell;
        place[b] = hilbert(static_cast<std::uint32_t>(at.x()), static_cast<std::uint32_t>(at.y()));
    }
    std::vector<int> order(blocks.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return place[a] < place[b]; });
    return order;
}

/// Fills in what follows from the outline and the holes.
void complete(CutBlock& block, CutReport& report) {
    block.area = signed_area(block.outline);
    for (const Polygon& hole : block.holes) block.area += signed_area(hole);
    block.parts = convex_parts(block.outline, block.holes);
    report.concave += block.parts.size() > 1;
    report.blocks_area += block.area;
}

}  // namespace

CutResult read_blocks(const PlanarMap& map, const std::vector<int>& of, CutReport report) {
    Tracer tracer(map, of);
    std::vector<CutBlock> blocks(of.size());
    for (int h = 0; h < static_cast<int>(map.half.size()); ++h) {
        if (!tracer.is_border(h) || tracer.seen(h)) continue;
        for (const std::vector<int>& loop : tracer.loops(h)) {
            Polygon polygon = corners(map, loop);
            CutBlock& block = blocks[tracer.block(h)];
            if (polygon.size() < 3) continue;
            if (signed_area(polygon) > 0.0) {
                block.outline = std::move(polygon);
            } else {
                block.holes.push_back(std::move(polygon));
                report.islands += tracer.block(loop[0] ^ 1) >= 0;
            }
        }
    }

    CutResult result;
    std::vector<int> number(of.size(), -1);  // [nf] place of a face's block in the result
    std::vector<int> face;
    std::vector<CutBlock> found;
    for (std::size_t f = 0; f < blocks.size(); ++f) {
        if (blocks[f].outline.empty()) continue;  // merged or dropped
        blocks[f].region = map.region[f];
        face.push_back(static_cast<int>(f));
        found.push_back(std::move(blocks[f]));
    }
    for (const int b : order_of(found, bounds(map.point))) {
        number[face[b]] = static_cast<int>(result.blocks.size());
        result.blocks.push_back(std::move(found[b]));
        complete(result.blocks.back(), report);
    }

    const auto numbered = [&](int h) { return tracer.block(h) < 0 ? -1 : number[tracer.block(h)]; };
    for (int h = 0; h < static_cast<int>(map.half.size()); h += 2) {
        const int left = numbered(h), right = numbered(h ^ 1);
        if (map.half[h].source >= 0 && left >= 0 && right >= 0 && left != right)
            result.seams.push_back({map.start(h), map.end(h), map.half[h].source, left, right});
    }
    result.report = std::move(report);
    return result;
}

}  // namespace talus
