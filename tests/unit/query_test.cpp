#include "model/query.hpp"

#include "core/random.hpp"
#include "geometry/polygon.hpp"
#include "model/material_point.hpp"
#include "output/snapshot.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/small_run.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numbers>

using namespace talus;
using Ids = std::vector<BlockId>;

namespace {

Ids entered(const std::vector<BlockQuery::Hit>& hits) {
    Ids blocks;
    for (const auto& hit : hits) blocks.push_back(hit.block);
    return blocks;
}

/// Polygons of three to seven corners and every size, and some Ls, thrown into a square of 20 m, overlapping and turned.
struct Heap {
    Model model;
    State state;

    explicit Heap(std::uint64_t seed) {
        Random random(seed);
        std::vector<std::vector<Polygon>> blocks;
        for (int i = 0; i < 60; ++i) {
            const double size = std::pow(10.0, 1.5 * random.uniform() - 1.0);
            if (i % 5 == 0) {
                blocks.push_back({test::rectangle(0, 0, 3 * size, size), test::rectangle(0, size, size, 2 * size)});
                continue;
            }
            const int corners = 3 + static_cast<int>(random.bits() % 5);
            Polygon polygon;
            for (int k = 0; k < corners; ++k) {
                const double angle = 2.0 * std::numbers::pi * k / corners;
                polygon.emplace_back(size * std::cos(angle), 0.6 * size * std::sin(angle));
            }
            blocks.push_back({polygon});
        }
        model = test::blocks_of_parts(blocks);
        state = test::at_rest(model);
        for (BlockId b = 0; b < model.blocks.size(); ++b) {
            state.motion.position[b] = {20.0 * random.uniform(), 20.0 * random.uniform()};
            state.motion.angle[b] = 20.0 * random.uniform() - 10.0;
            state.removed[b] = b % 7 == 3;
        }
    }

    Polygon part(PartId p) const {
        const BlockId b = model.parts.block[p];
        Polygon polygon;
        for (int k = model.parts.first_corner[p]; k < model.parts.first_corner[p + 1]; ++k)
            polygon.push_back(state.motion.position[b] + turned(model.corners.arm[k], state.motion.angle[b]));
        return polygon;
    }

    /// Blocks of which some part fits, by looking at all.
    template <class Fits>
    std::vector<BlockId> all_where(Fits&& fits) const {
        std::vector<BlockId> found;
        for (PartId p = 0; p < model.parts.size(); ++p) {
            const BlockId b = model.parts.block[p];
            if (!state.removed[b] && (found.empty() || found.back() != b) && fits(part(p))) found.push_back(b);
        }
        return found;
    }
};

bool cross_each_other(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    return cross(b - a, c - a) * cross(b - a, d - a) <= 0.0 && cross(d - c, a - c) * cross(d - c, b - c) <= 0.0;
}

bool share_a_point(const Polygon& p, const Polygon& q) {
    for (std::size_t i = 0; i < p.size(); ++i)
        for (std::size_t j = 0; j < q.size(); ++j)
            if (cross_each_other(p[i], p[(i + 1) % p.size()], q[j], q[(j + 1) % q.size()])) return true;
    return contains(p, q[0]) || contains(q, p[0]);
}

}  // namespace

TEST_CASE("a point is held by every block that touches it") {
    const Model model = test::wall(3, 2);
    State state = test::at_rest(model);
    const BlockQuery query(model, state);
    CHECK(query.at({0.5, 0.5}) == Ids{0});
    CHECK(query.at({1.0, 0.5}) == Ids{0, 1});
    CHECK(query.at({1.0, 1.0}) == Ids{0, 1, 3, 4});
    CHECK(query.at({3.0, 2.0}) == Ids{5});
    CHECK(query.at({3.0 + 1e-12, 1.5}) == Ids{5});
    CHECK(query.at({3.0 + 1e-6, 1.5}).empty());
    state.removed[4] = 1;
    CHECK(BlockQuery(model, state).at({1.0, 1.0}) == Ids{0, 1, 3});
    CHECK(query.at({1.0, 1.0}) == Ids{0, 1, 3, 4});  // it keeps what it was made for
}

TEST_CASE("a rectangle meets blocks that touch it, not those of which it meets the bounds only") {
    Model model = test::wall(3, 2);
    State state = test::at_rest(model);
    const BlockQuery query(model, state);
    CHECK(query.in({0.2, 0.2, 0.8, 0.8}) == Ids{0});
    CHECK(query.in({1.0, 0.2, 1.5, 0.8}) == Ids{0, 1});
    CHECK(query.in({-9, -9, 9, 9}) == Ids{0, 1, 2, 3, 4, 5});
    CHECK(query.in({1.5, 0.5, 1.5, 0.5}) == Ids{1});  // a point
    CHECK(query.in({0.8, 0.8, 0.2, 0.2}).empty());
    state.motion.angle[5] = std::numbers::pi / 4;  // a corner of its bounds is no longer its own
    CHECK(BlockQuery(model, state).in({2.95, 1.95, 3.1, 2.1}).empty());
    CHECK(BlockQuery(model, state).in({2.7, 1.7, 3.1, 2.1}) == Ids{5});
}

TEST_CASE("a line tells where it enters and leaves each block") {
    const Model model = test::wall(4, 1);
    const State state = test::at_rest(model);
    const BlockQuery query(model, state);
    const auto hits = query.along({3.5, 0.5}, {-2.0, 0.5});  // from inside, against the numbering
    REQUIRE(entered(hits) == Ids{3, 2, 1, 0});
    CHECK(hits[0].entry == 0.0);
    for (int i = 0; i < 4; ++i) {
        CHECK(hits[i].exit == Approx(0.5 + i));
        CHECK(hits[i].inside == Approx(i == 0 ? 0.5 : 1.0));
        if (i > 0) CHECK(hits[i].entry == Approx(hits[i - 1].exit));
    }
    CHECK(entered(query.along({0.5, 1.0}, {1.5, 1.0})) == Ids{0, 1});   // along the edges
    CHECK(entered(query.along({1.0, -1.0}, {1.0, 2.0})) == Ids{0, 1});  // along the joint: both sides
    CHECK(query.along({0.5, 1.001}, {1.5, 1.001}).empty());
    CHECK(entered(query.along({2.5, 0.5}, {2.5, 0.5})) == Ids{2});  // no longer than a point
}

TEST_CASE("a line that leaves a concave block and comes back meets it once") {
    const Model model = test::blocks_of_parts(  // a U of 3 x 3 with a square in its middle
        {{test::rectangle(0, 0, 3, 1), test::rectangle(0, 1, 1, 2), test::rectangle(2, 1, 1, 2)},
         {test::rectangle(1.25, 1.5, 0.5, 0.5)}});
    const auto hits = BlockQuery(model, test::at_rest(model)).along({-1, 1.75}, {9, 1.75});
    REQUIRE(entered(hits) == Ids{0, 1});
    CHECK(hits[0].entry == Approx(1.0));
    CHECK(hits[0].exit == Approx(4.0));
    CHECK(hits[0].inside == Approx(2.0));
    CHECK(hits[1].entry == Approx(2.25));
    const auto through_two_parts = BlockQuery(model, test::at_rest(model)).along({0.5, -1}, {0.5, 9});
    REQUIRE(entered(through_two_parts) == Ids{0});
    CHECK(through_two_parts[0].inside == Approx(3.0));
}

TEST_CASE("questions of place find what looking at every block finds") {
    for (const std::uint64_t seed : {1, 2, 3}) {
        const Heap heap(seed);
        const BlockQuery query(heap.model, heap.state);
        Random random(seed + 100);
        const auto anywhere = [&] { return Vec2(24.0 * random.uniform() - 2.0, 24.0 * random.uniform() - 2.0); };
        for (int i = 0; i < 200; ++i) {
            const Vec2 from = anywhere(), to = anywhere();
            CHECK(query.at(from) == heap.all_where([&](const Polygon& part) { return contains(part, from); }));

            const Vec2 other = i % 2 ? to : Vec2(from + Vec2(0.1, 0.2)), low = from.cwiseMin(other),
                       high = from.cwiseMax(other);
            const Polygon rectangle{low, {high.x(), low.y()}, high, {low.x(), high.y()}};
            CHECK(query.in({low.x(), low.y(), high.x(), high.y()}) ==
                  heap.all_where([&](const Polygon& part) { return share_a_point(part, rectangle); }));

            std::map<BlockId, std::array<double, 3>> expected;  // entry, exit, inside
            for (PartId p = 0; p < heap.model.parts.size(); ++p)
                for (const auto& [a, b] : pieces_inside(heap.part(p), from, to)) {
                    if (heap.state.removed[heap.model.parts.block[p]]) continue;
                    const double entry = (a - from).norm(), exit = (b - from).norm();
                    auto& all = expected.try_emplace(heap.model.parts.block[p], std::array{entry, exit, 0.0}).first->second;
                    all = {std::min(all[0], entry), std::max(all[1], exit), all[2] + exit - entry};
                }
            const auto hits = query.along(from, to);
            CHECK(std::is_sorted(hits.begin(), hits.end(), [](auto& x, auto& y) { return x.entry < y.entry; }));
            REQUIRE(hits.size() == expected.size());
            for (const auto& hit : hits) {
                REQUIRE(expected.contains(hit.block));
                const auto [entry, exit, inside] = expected[hit.block];
                CHECK(hit.entry == Approx(entry).margin(1e-9));
                CHECK(hit.exit == Approx(exit).margin(1e-9));
                CHECK(hit.inside == Approx(inside).margin(1e-9));
            }
        }
    }
}

TEST_CASE("blocks of a result are found where they were at a frame") {
    const test::Folder folder;
    const Model model = test::l_and_square();
    {
        ResultsWriter writer(folder / "wall.h5", model, test::run_info());
        const int toe = test::add_toe(writer);
        for (std::int64_t k = 0; k < 4; ++k) test::write_frame(writer, model, toe, k);
    }
    for (const std::int64_t k : {0, 2, 3}) {
        const State then = test::state_of_frame(model, k);
        const Snapshot snapshot = read_snapshot(folder / "wall.h5", k == 3 ? std::optional<std::int64_t>() : k);
        CHECK(snapshot.frame == k);
        CHECK(snapshot.time == then.time);
        CHECK(snapshot.position == then.motion.position);
        const BlockQuery saved(snapshot.parts, snapshot.corners, snapshot.position, snapshot.angle, snapshot.removed);
        const BlockQuery now(model, then);
        for (double x = -3.0; x < 6.0; x += 0.21)
            for (double y = -3.0; y < 6.0; y += 0.21) CHECK(saved.at({x, y}) == now.at({x, y}));
    }
    CHECK_THROWS_WITH(read_snapshot(folder / "wall.h5", 4), Catch::Contains("there is no frame 4, the last one is 3"));
    CHECK_THROWS_WITH(read_snapshot(folder / "wall.h5", -1), Catch::Contains("there is no frame -1"));
}
