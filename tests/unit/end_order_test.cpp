#include "contact/end_order.hpp"
#include "contact/end_disorder.hpp"
#include "contact/pair_set.hpp"
#include "core/random.hpp"
#include "support/catch.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

using namespace talus;

TEST_CASE("every vector unit finds the ends that are not above the one before, ties and no numbers included") {
    Random random(1);
    for (const int count : {1, 2, 7, 8, 9, 63, 300}) {
        std::vector<double> coordinate(2 * count);
        std::vector<int> tag(count), expected;
        std::iota(tag.begin(), tag.end(), 0);
        for (int t = 0; t < count; ++t) {
            coordinate[2 * t] = t + (random.uniform() < 0.2 ? -1.0 : 0.0);  // some equal to the one before
            if (random.uniform() < 0.05) coordinate[2 * t] = std::numeric_limits<double>::quiet_NaN();
        }
        if (count > 8) std::swap(tag[3], tag[count - 2]);
        for (int from = 1; from <= std::min(count, 12); ++from) {
            expected.clear();
            for (int k = from; k < count; ++k)
                if (!(coordinate[2 * tag[k - 1]] < coordinate[2 * tag[k]])) expected.push_back(k);
            for (const VectorUnit unit : {VectorUnit::baseline, VectorUnit::avx2, VectorUnit::avx512}) {
                if (!has(unit)) continue;
                std::vector<int> places(count - from + 8);
                places.resize(disorder_kernel(unit)(coordinate.data(), tag.data(), from, count, places.data()));
                CAPTURE(count, from, static_cast<int>(unit));
                CHECK(places == expected);
            }
        }
    }
}

TEST_CASE("ends are listed by coordinate, lower ends first, and a list repaired in chunks is the list built anew") {
    EndOrder small(EndOrder::Axis::x);
    small.build(std::vector<Box>{{1, 0, 2, 1}, {-0.0, 0, 1, 1}, {5, 0, 4, 1}, {0.0, 0, 0, 1}, {-3, 0, 1, 1}});
    const std::vector<int> expected{8, 2, 6, 7, 0, 3, 9, 1};  // 2 box + 1 for an upper end; the inverted box is not there
    CHECK(std::vector<int>(small.tags().begin(), small.tags().end()) == expected);

    Random random(2);
    std::vector<Box> boxes;
    for (int i = 0; i < 700; ++i) {
        const double x = random.uniform(), y = random.uniform();
        boxes.push_back({x, y, x + 0.02 * random.uniform(), y + 0.02});
    }
    std::int64_t exchanges[2] = {};
    for (const int chunks : {1, 5}) {
        EndOrder ends(EndOrder::Axis::y), anew(EndOrder::Axis::y);
        std::vector<Box> moving = boxes;
        ends.build(moving);
        Random shaking(3);
        for (int step = 0; step < 20; ++step) {
            for (Box& box : moving) {
                const double by = 0.002 * shaking.normal();
                box.ymin += by, box.ymax += by;
            }
            for (int chunk = 0; chunk < chunks; ++chunk) {
                Crossings met;
                REQUIRE(ends.repair(moving, ends.size() * chunk / chunks, ends.size() * (chunk + 1) / chunks, met));
                exchanges[chunks > 1] += met.exchanges;
            }
            for (int chunk = 1; chunk < chunks; ++chunk) {
                Crossings met;
                REQUIRE(ends.join(moving, ends.size() * chunk / chunks, ends.size() * (chunk + 1) / chunks, met));
                exchanges[chunks > 1] += met.exchanges;
            }
            anew.build(moving);
            REQUIRE(std::ranges::equal(ends.tags(), anew.tags()));
        }
    }
    CHECK(exchanges[0] > 10000);
    CHECK(exchanges[0] == exchanges[1]);
}

TEST_CASE("a repair refuses boxes that are not present any more") {
    const std::vector<Box> boxes{{0, 0, 1, 1}, {0.5, 0, 2, 1}, {3, 0, 4, 1}};
    const double no_number = std::numeric_limits<double>::quiet_NaN();
    for (int i = 0; i < 3; ++i)
        for (const Box& gone : {Box{no_number, 0, 1, 1}, Box{1, 0, no_number, 1}, Box{no_number, 0, no_number, 1},
                                Box{1, 0, 0, 1}, Box{3.5, 0, 0.7, 1}}) {
            EndOrder ends(EndOrder::Axis::x);
            ends.build(boxes);
            std::vector<Box> now = boxes;
            now[i] = gone;
            Crossings met;
            CHECK_FALSE(ends.repair(now, 0, ends.size(), met));
        }
}

TEST_CASE("a set of pairs takes in and out what it is told, once, and lists it in order") {
    Random random(4);
    PairSet set;
    set.assign(30, std::vector<Pair>{{3, 9}, {0, 1}, {3, 4}});
    std::vector<Pair> expected{{0, 1}, {3, 4}, {3, 9}}, listed;
    for (int step = 0; step < 3000; ++step) {
        const int a = static_cast<int>(random.bits() % 4), b = a + 1 + static_cast<int>(random.bits() % 25);  // many to each
        const auto place = std::lower_bound(expected.begin(), expected.end(), Pair{a, b});
        const bool there = place != expected.end() && *place == Pair{a, b};
        if (random.uniform() < 0.5 + 0.3 * std::sin(0.01 * step)) {
            set.insert({a, b});
            if (!there) expected.insert(place, {a, b});
        } else {
            set.erase({a, b});
            if (there) expected.erase(place);
        }
        set.list(listed);
        REQUIRE(listed == expected);
    }
    set.assign(0, {});
    set.list(listed);
    CHECK(listed.empty());
}
