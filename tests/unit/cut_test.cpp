#include "geometry/cut.hpp"
#include "core/random.hpp"
#include "geometry/polygon.hpp"
#include "support/catch.hpp"

#include <algorithm>
#include <map>
#include <set>

using namespace talus;

namespace {

Polygon box_outline(double x0, double y0, double x1, double y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }

bool contains(const CutBlock& block, const Vec2& point) {
    return talus::contains(block.outline, point) &&
           std::none_of(block.holes.begin(), block.holes.end(),
                        [&](const auto& hole) { return talus::contains(hole, point); });
}

CutInput rock(Polygon outline) {
    CutInput input;
    input.outline = std::move(outline);
    return input;
}

const CutBlock& block_at(const CutResult& result, const Vec2& point) {
    for (const CutBlock& block : result.blocks)
        if (contains(block, point)) return block;
    FAIL("no block there");
    return result.blocks[0];
}

/// Straight lines across the square [0, size]^2, each through a random point near it.
std::vector<CutLine> random_lines(int sets, int per_set, double size, std::uint64_t seed) {
    Random random(seed);
    std::vector<CutLine> lines;
    for (int set = 0; set < sets; ++set)
        for (int i = 0; i < per_set; ++i) {
            const double angle = radians(180.0 * set / sets + 17.0) + 0.03 * random.normal();
            const Vec2 along(std::cos(angle), std::sin(angle));
            const Vec2 through = Vec2(size, size) / 2.0 + 1.4 * size * (random.uniform() - 0.5) * perp(along);
            lines.push_back({through - 2.0 * size * along, through + 2.0 * size * along, set});
        }
    return lines;
}

/// What holds for every cut: areas add up, parts are convex and make up their block, corners are true ones, the same block
/// does not come twice, and the tallies of the report are those of the blocks.
void check_blocks(const CutResult& result, double area) {
    double sum = 0.0;
    int concave = 0;
    std::set<std::pair<double, double>> centroids;
    for (const CutBlock& block : result.blocks) {
        double own = signed_area(block.outline), parts = 0.0;
        for (const Polygon& hole : block.holes) own += signed_area(hole);
        for (const Polygon& part : block.parts) {
            parts += signed_area(part);
            CHECK(is_convex(part));
            CHECK(without_straight_corners(part).size() == part.size());
        }
        CHECK(block.area > 0.0);
        CHECK(block.area == Approx(own).epsilon(1e-12));
        CHECK(std::abs(parts - own) < 1e-14 * area);
        CHECK(is_simple(block.outline));
        CHECK(without_straight_corners(block.outline).size() == block.outline.size());
        CHECK((block.parts.size() == 1) == (block.holes.empty() && is_convex(block.outline)));
        const Vec2 c = centroid(block.outline);
        CHECK(centroids.insert({c.x(), c.y()}).second);
        concave += block.parts.size() > 1;
        sum += block.area;
    }
    CHECK(std::abs(sum / area - 1.0) < 1e-12);
    CHECK(std::abs(result.report.outline_area / area - 1.0) < 1e-12);
    CHECK(result.report.blocks_area == Approx(sum).epsilon(1e-14));
    CHECK(result.report.concave == concave);
}

/// Every random point of the outline lies in exactly one block.
void check_cover(const CutResult& result, const Polygon& outline, int points) {
    std::vector<Box> boxes;
    for (const CutBlock& block : result.blocks) boxes.push_back(bounds(block.outline));
    const Box box = bounds(outline);
    Random random(99);
    for (int i = 0; i < points; ++i) {
        const Vec2 p(box.xmin + random.uniform() * (box.xmax - box.xmin),
                     box.ymin + random.uniform() * (box.ymax - box.ymin));
        int found = 0;
        for (std::size_t b = 0; b < boxes.size(); ++b)
            if (boxes[b].overlaps({p.x(), p.y(), p.x(), p.y()})) found += contains(result.blocks[b], p);
        REQUIRE(found == static_cast<int>(talus::contains(outline, p)));
    }
}

}  // namespace

TEST_CASE("two crossing lines cut a square into four blocks of known area") {
    CutInput input = rock(box_outline(0, 0, 4, 2));
    input.lines = {{{1, -1}, {1, 3}, 0}, {{-1, 0.5}, {5, 0.5}, 1}};
    const CutResult result = cut(input);
    REQUIRE(result.blocks.size() == 4);
    check_blocks(result, 8.0);
    CHECK(block_at(result, {0.5, 0.25}).outline.size() == 4);
    CHECK(block_at(result, {0.5, 0.25}).area == 0.5);
    CHECK(block_at(result, {2.0, 0.25}).area == 1.5);
    CHECK(block_at(result, {0.5, 1.0}).area == 1.5);
    CHECK(block_at(result, {2.0, 1.0}).area == 4.5);
    CHECK(result.report.dangling == 0);
}

TEST_CASE("seams are the pieces of a line between two blocks, with the blocks on either side") {
    CutInput input = rock(box_outline(0, 0, 4, 2));
    input.lines = {{{1, -1}, {1, 3}, 5}, {{-1, 0.5}, {5, 0.5}, 3}};
    const CutResult result = cut(input);
    std::map<int, double> length;
    for (const CutSeam& seam : result.seams) {
        length[seam.source] += (seam.to - seam.from).norm();
        const Vec2 middle = (seam.from + seam.to) / 2.0;
        const Vec2 left = middle + 0.01 * perp(seam.to - seam.from), right = middle - 0.01 * perp(seam.to - seam.from);
        CHECK(contains(result.blocks[seam.left], left));
        CHECK(contains(result.blocks[seam.right], right));
    }
    CHECK(length == std::map<int, double>{{3, 4.0}, {5, 2.0}});
}

TEST_CASE("where lines of two sources coincide the lower one counts") {
    CutInput input = rock(box_outline(0, 0, 4, 2));
    input.lines = {{{-1, 1}, {3, 1}, 7}, {{1, 1}, {5, 1}, 2}};
    std::map<int, double> length;
    for (const CutSeam& seam : cut(input).seams) length[seam.source] += (seam.to - seam.from).norm();
    CHECK(length == std::map<int, double>{{2, 3.0}, {7, 1.0}});
}

TEST_CASE("ends that stop inside a block cut nothing and are counted") {
    CutInput input = rock(box_outline(0, 0, 4, 2));
    input.lines = {{{2, -1}, {2, 3}, 0}, {{-1, 1}, {1, 1}, 1}, {{2.5, 0.5}, {3.5, 1.5}, 2}, {{3.5, 0.5}, {2.5, 1.5}, 2}};
    const CutResult result = cut(input);
    CHECK(result.blocks.size() == 2);
    CHECK(result.report.dangling == 5);  // one of line 1, all four of the cross
    check_blocks(result, 8.0);
    for (const CutBlock& block : result.blocks) CHECK(block.outline.size() == 4);
    for (const CutSeam& seam : result.seams) CHECK(seam.source == 0);
}

TEST_CASE("lines along the outline, through its corners or outside it leave no trace") {
    CutInput input = rock({{0, 0}, {40, 0}, {40, 15}, {25, 40}, {0, 40}});
    input.lines = {{{-1, 0}, {41, 0}, 0}, {{40, -5}, {40, 50}, 0}, {{-10, 50}, {50, -10}, 1}, {{0, 41}, {41, 0}, 2}};
    input.lines.push_back({{45, 0}, {60, 30}, 3});
    const Vec2 face = (Vec2(25, 40) - Vec2(40, 15)).normalized();  // along the slope, off it by the rounding of the ends
    input.lines.push_back({Vec2(40, 15) - 3.0 * face, Vec2(25, 40) + 3.0 * face, 4});
    const CutResult result = cut(input);
    check_blocks(result, 40.0 * 40.0 - 15.0 * 25.0 / 2.0);
    CHECK(result.blocks.size() == 3);
    CHECK(result.report.dropped == 0);
    check_cover(result, input.outline, 2000);
}

TEST_CASE("corners where only the neighbour has one are left out, so that blocks touch along parts of longer edges") {
    CutInput input = rock(box_outline(0, 0, 6, 2));
    input.lines = {{{-1, 1}, {7, 1}, 0}, {{2, 1}, {2, 3}, 1}, {{3, -1}, {3, 1}, 1}};
    const CutResult result = cut(input);
    REQUIRE(result.blocks.size() == 4);
    for (const CutBlock& block : result.blocks) CHECK(block.outline.size() == 4);

    input.lines.clear();  // an outline drawn with corners along its straight sides
    input.outline = {{0, 0}, {0.1, 0}, {0.3, 0}, {0.3, 0.1}, {0.3, 0.3}, {0.2, 0.2}, {0.1, 0.1}};
    CHECK(cut(input).blocks.at(0).outline.size() == 3);
}

TEST_CASE("five joint sets cut a square into thousands of blocks that add up to it") {
    CutInput input = rock(box_outline(0, 0, 100, 100));
    input.lines = random_lines(5, 50, 100.0, 1);
    const CutResult result = cut(input);
    CHECK(result.blocks.size() > 5000);
    check_blocks(result, 1e4);
    check_cover(result, input.outline, 3000);
    CHECK(result.report.concave == 0);  // straight lines through a convex outline

    // Euler: an arrangement of straight lines has 1 + lines + crossings regions, counted inside the square.
    int crossings = 0, lines = 0;
    for (std::size_t i = 0; i < input.lines.size(); ++i) {
        const Vec2 p = input.lines[i].from, u = input.lines[i].to - p;
        lines += !pieces_inside(input.outline, p, input.lines[i].to).empty();
        for (std::size_t j = 0; j < i; ++j) {
            const Vec2 q = input.lines[j].from, v = input.lines[j].to - q;
            const Vec2 x = p + cross(q - p, v) / cross(u, v) * u;
            crossings += x.minCoeff() > 0.0 && x.maxCoeff() < 100.0;
        }
    }
    CHECK(static_cast<int>(result.blocks.size()) + result.report.merged == 1 + lines + crossings);

    const CutResult again = cut(input);
    for (std::size_t b = 0; b < result.blocks.size(); ++b) REQUIRE(again.blocks[b].outline == result.blocks[b].outline);
}

TEST_CASE("blocks that follow each other lie near each other") {
    CutInput input = rock(box_outline(0, 0, 100, 100));
    input.lines = random_lines(2, 50, 100.0, 2);
    const CutResult result = cut(input);
    double way = 0.0;
    for (std::size_t b = 1; b < result.blocks.size(); ++b)
        way += (centroid(result.blocks[b].outline) - centroid(result.blocks[b - 1].outline)).norm();
    const double size = 100.0 / std::sqrt(static_cast<double>(result.blocks.size()));
    CHECK(way / static_cast<double>(result.blocks.size()) < 2.0 * size);  // a random order gives 52 m, 15 times as much
}

TEST_CASE("three sets that nearly meet in a point leave slivers, which go to the neighbour of the longest edge") {
    CutInput input = rock(box_outline(0, 0, 2, 2));
    input.lines = {{{-1, 1}, {3, 1}, 0}, {{0, 0}, {2, 2}, 1}, {{1e-6, 2}, {2 + 1e-6, 0}, 2}};
    const CutResult all = cut(input);
    CHECK(all.blocks.size() == 7);  // six and the triangle between the three lines
    check_blocks(all, 4.0);

    input.sliver_area = 1e-9;
    const CutResult merged = cut(input);
    CHECK(merged.blocks.size() == 6);
    CHECK(merged.report.merged == 1);
    CHECK(merged.report.merged_area == Approx(1e-12 / 4.0).epsilon(1e-6));  // right angle at the top, base 1e-6
    REQUIRE(merged.report.merged_at.size() == 1);
    CHECK((merged.report.merged_at[0] - Vec2(1, 1)).norm() < 1e-6);
    check_blocks(merged, 4.0);
}

TEST_CASE("the sliver rule: below either limit, smallest first, into the longest common edge, again while one is left") {
    CutInput input = rock(box_outline(0, 0, 10, 10));
    // columns of width 0.01 and 0.02 between blocks of 4 and 5.97 m; the lower 8 m of the boundary on the right are cut
    // finer
    input.lines = {{{4, -1}, {4, 11}, 0}, {{4.01, -1}, {4.01, 11}, 0}, {{4.03, -1}, {4.03, 11}, 0}, {{4.03, 6}, {11, 6}, 1}};
    const CutResult all = cut(input);
    CHECK(all.blocks.size() == 5);
    CHECK(all.report.merged == 0);

    SECTION("width: both columns go left one after the other, for on the right the edge is shorter") {
        input.sliver_width = 0.05;
        const CutResult result = cut(input);
        CHECK(result.blocks.size() == 3);
        CHECK(result.report.merged == 2);
        CHECK(result.report.merged_area == Approx(0.1 + 0.3));  // the first has joined the second when that is merged
        CHECK(block_at(result, {1, 1}).area == Approx(40.3).epsilon(1e-12));
        check_blocks(result, 100.0);
    }
    SECTION("area: the limit lies between the two") {
        input.sliver_area = 0.15;
        const CutResult result = cut(input);
        CHECK(result.blocks.size() == 4);
        CHECK(result.report.merged == 1);
    }
    SECTION("limits as shares of the mean block") {
        input.sliver_area_share = 0.0075;  // mean 20 m2
        CHECK(cut(input).blocks.size() == 4);
        CHECK(cut(input).report.sliver_area == Approx(0.15));
        input.sliver_area_share = 0.0;
        input.sliver_width_share = 0.05 / std::sqrt(20.0);
        CHECK(cut(input).blocks.size() == 3);
    }
}

TEST_CASE("a sliver without a neighbour is dropped and counted") {
    CutInput input = rock(box_outline(0, 0, 10, 10));
    input.holes = {{{9.99, -1}, {9.995, -1}, {9.995, 11}, {9.99, 11}}};  // leaves a strip of 5 mm
    input.sliver_width = 0.01;
    const CutResult result = cut(input);
    CHECK(result.blocks.size() == 1);
    CHECK(result.report.dropped == 1);
    CHECK(result.report.dropped_area == Approx(0.05));
    CHECK(result.report.outline_area - result.report.blocks_area == Approx(0.05));
}

TEST_CASE("a joint a rounding error beside the outline of a region still parts the region from the rest") {
    CutInput input = rock(box_outline(0, 0, 3, 3));
    input.regions = {{box_outline(0, 0, 3, 0.3), 4}};
    for (const double y : {0.3, std::nextafter(0.3, 1.0), std::nextafter(0.3, 0.0)}) {
        input.lines = {{{-1, y}, {4, y}, 0}};
        const CutResult result = cut(input);
        REQUIRE(result.blocks.size() == 2);
        REQUIRE(result.seams.size() >= 1);
        double length = 0.0;
        for (const CutSeam& seam : result.seams) length += (seam.to - seam.from).norm();
        CHECK(length == Approx(3.0));
        CHECK(block_at(result, {1, 0.1}).region == 4);
        CHECK(block_at(result, {1, 1}).region == -1);
    }
}

TEST_CASE("holes are cut out, wherever they lie and however they overlap") {
    CutInput input = rock(box_outline(0, 0, 10, 10));
    input.holes = {box_outline(2, 2, 4, 4), box_outline(3, 3, 5, 5), box_outline(9, 9, 12, 12)};
    const double area = 100.0 - 4.0 - 3.0 - 1.0;
    const CutResult whole = cut(input);
    REQUIRE(whole.blocks.size() == 1);
    CHECK(whole.blocks[0].holes.size() == 1);
    CHECK(whole.report.islands == 0);  // nothing lies in the hole
    check_blocks(whole, area);

    input.lines = {{{-1, 3.5}, {11, 3.5}, 0}};
    const CutResult result = cut(input);
    CHECK(result.blocks.size() == 2);
    check_blocks(result, area);
}

TEST_CASE("a block inside another one is an island, and the block around it gets convex parts") {
    CutInput input = rock(box_outline(0, 0, 10, 10));
    const Polygon ring = box_outline(3, 3, 6, 6);
    for (int i = 0; i < 4; ++i) input.lines.push_back({ring[i], ring[(i + 1) % 4], 0});
    input.lines.push_back({{4, 3}, {4, 6}, 0});    // two blocks inside, one island
    input.lines.push_back({{6, 6}, {10, 10}, 1});  // a bridge to the outline cuts nothing
    const CutResult result = cut(input);
    REQUIRE(result.blocks.size() == 3);
    CHECK(result.report.islands == 1);
    CHECK(result.report.concave == 1);
    const CutBlock& around = block_at(result, {1, 1});
    CHECK(around.holes == std::vector<Polygon>{{{3, 3}, {3, 6}, {6, 6}, {6, 3}}});
    CHECK(around.parts.size() == 4);
    check_blocks(result, 100.0);
    check_cover(result, input.outline, 2000);
}

TEST_CASE("an island that touches the outline of its block at one corner") {
    CutInput input = rock(box_outline(0, 0, 10, 10));
    const Polygon triangle{{0, 5}, {4, 3}, {4, 7}};
    for (int i = 0; i < 3; ++i) input.lines.push_back({triangle[i], triangle[(i + 1) % 3], 0});
    const CutResult result = cut(input);
    REQUIRE(result.blocks.size() == 2);
    CHECK(block_at(result, {9, 9}).holes.size() == 1);
    check_blocks(result, 100.0);
    check_cover(result, input.outline, 2000);
}

TEST_CASE("blocks carry the last region that contains them, and are cut along its outline") {
    CutInput input = rock(box_outline(0, 0, 10, 10));
    input.regions = {{box_outline(2, 2, 8, 8), 3}, {box_outline(5, 5, 12, 12), 8}};
    const CutResult result = cut(input);
    REQUIRE(result.blocks.size() == 4);
    CHECK(block_at(result, {3, 3}).region == 3);
    CHECK(block_at(result, {6, 6}).region == 8);  // in both
    CHECK(block_at(result, {9, 9}).region == 8);
    CHECK(block_at(result, {1, 1}).region == -1);
    CHECK(block_at(result, {3, 3}).area == Approx(27.0));
    CHECK(result.seams.empty());  // an outline is no joint
    check_blocks(result, 100.0);
}

TEST_CASE("concave polygons are parted by few diagonals between their own corners") {
    const Polygon u_shape{{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
    const Polygon l_shape{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
    CHECK(convex_parts(l_shape).size() == 2);
    CHECK(convex_parts(u_shape).size() == 3);
    CHECK(convex_parts({{0, 0}, {1, 0}, {0, 1}}) == std::vector<Polygon>{{{0, 0}, {1, 0}, {0, 1}}});

    const auto square_ring = convex_parts({{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{{1, 1}, {1, 3}, {3, 3}, {3, 1}}});
    CHECK(square_ring.size() == 4);

    // Random star-shaped outlines with a hole: areas add up, and each inner edge is met exactly once in each direction.
    Random random(5);
    for (int trial = 0; trial < 200; ++trial) {
        Polygon outline, hole;
        const int n = 5 + trial % 40;
        for (int i = 0; i < n; ++i) {
            const Vec2 along(std::cos(2 * std::numbers::pi * i / n), std::sin(2 * std::numbers::pi * i / n));
            outline.push_back((1.0 + 3.0 * random.uniform()) * along);
            if (n % 2) hole.insert(hole.begin(), (0.1 + 0.5 * random.uniform()) * along);
        }
        const auto parts = hole.empty() ? convex_parts(outline) : convex_parts(outline, {hole});
        std::map<std::pair<std::pair<double, double>, std::pair<double, double>>, int> edges;
        double area = 0.0;
        for (const Polygon& part : parts) {
            REQUIRE(is_convex(part));
            area += signed_area(part);
            for (std::size_t i = 0; i < part.size(); ++i) {
                const Vec2 &p = part[i], &q = part[(i + 1) % part.size()];
                ++edges[{{p.x(), p.y()}, {q.x(), q.y()}}];
            }
        }
        CHECK(area == Approx(signed_area(outline) + signed_area(hole)).epsilon(1e-13));
        std::size_t outer = 0;
        for (const auto& [edge, count] : edges) {
            REQUIRE(count == 1);
            outer += !edges.contains({edge.second, edge.first});
        }
        CHECK(outer == outline.size() + hole.size());
    }
}

TEST_CASE("corners in one line, necks and tails give no part without thickness") {
    for (const double angle : {0.0, 0.1, 0.7, 1.1}) {  // a cross, turned so that its corners are in line but for rounding
        Polygon cross_shape{{1, 0}, {2, 0}, {2, 1}, {3, 1}, {3, 2}, {2, 2}, {2, 3}, {1, 3}, {1, 2}, {0, 2}, {0, 1}, {1, 1}};
        for (Vec2& p : cross_shape) p = std::cos(angle) * p + std::sin(angle) * perp(p);
        double area = 0.0;
        for (const Polygon& part : convex_parts(cross_shape)) {
            CHECK(is_convex(part));
            CHECK(smallest_width(part) > 0.5);
            area += signed_area(part);
        }
        CHECK(area == Approx(5.0).epsilon(1e-14));
    }
    for (const double width : {1e-15, 1e-12, 1e-10}) {  // an hourglass
        const Polygon hourglass{{0, 0}, {2, 0}, {1 + width, 1}, {2, 2}, {0, 2}, {1, 1}};
        double area = 0.0;
        for (const Polygon& part : convex_parts(hourglass)) {
            CHECK(smallest_width(part) > 0.5);
            area += signed_area(part);
        }
        CHECK(area == Approx(2.0).epsilon(1e-9));
    }
}

TEST_CASE("cutting far from the origin gives the same blocks, moved") {
    const Vec2 far(4.5e5, 6.5e6);  // exact in binary, like all numbers here
    CutInput input = rock(box_outline(0, 0, 8, 8));
    input.lines = {{{-1, 2.5}, {9, 4.25}, 0}, {{1.25, -1}, {3.5, 9}, 1}, {{0.5, 9}, {8.75, 0.25}, 1}};
    const CutResult here = cut(input);
    for (Vec2& p : input.outline) p += far;
    for (CutLine& line : input.lines) line.from += far, line.to += far;
    const CutResult there = cut(input);
    REQUIRE(there.blocks.size() == here.blocks.size());
    for (std::size_t b = 0; b < here.blocks.size(); ++b) {
        REQUIRE(there.blocks[b].outline.size() == here.blocks[b].outline.size());
        CHECK((centroid(there.blocks[b].outline) - far - centroid(here.blocks[b].outline)).norm() < 5e-9);
    }
}
