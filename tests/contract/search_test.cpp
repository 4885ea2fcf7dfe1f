// Every search gives, at every step, exactly the pairs that a comparison of each box with each other gives; what it
// remembers of earlier steps changes nothing. Scenes are made to hurt: ties, nesting, vanishing boxes, jumps.
#include "contact/search.hpp"
#include "core/errors.hpp"
#include "core/random.hpp"
#include "support/catch.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <set>

#ifdef _OPENMP
#include <omp.h>
#endif

using namespace talus;

namespace {

constexpr double huge = std::numeric_limits<double>::max();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr Box absent{1.0, 0.0, 0.0, 1.0};  // overlaps the unit square if only coordinates were compared

using Boxes = std::vector<Box>;

/// The definition, written out without the library: closed intervals along x and y have a point in common.
std::vector<Pair> overlapping(const Boxes& boxes) {
    const auto is_box = [](const Box& b) { return b.xmin <= b.xmax && b.ymin <= b.ymax; };
    std::vector<Pair> pairs;
    for (int a = 0; a < std::ssize(boxes); ++a)
        for (int b = a + 1; b < std::ssize(boxes); ++b) {
            const Box &p = boxes[a], &q = boxes[b];
            const bool x = std::max(p.xmin, q.xmin) <= std::min(p.xmax, q.xmax);
            const bool y = std::max(p.ymin, q.ymin) <= std::min(p.ymax, q.ymax);
            if (is_box(p) && is_box(q) && x && y) pairs.push_back({a, b});
        }
    return pairs;
}

/// Runs a motion through every search, warm and fresh. Returns how often the set of pairs differed from the one before, so
/// that a test can ask that its motion moved anything.
int follow(int steps, const std::function<void(int step, Boxes&)>& move) {
    std::vector<std::unique_ptr<PairSearch>> warm;
    for (const char* name : search_names()) warm.push_back(make_search(name));
    Boxes boxes;
    std::vector<Pair> last, found{{3, 1}, {3, 1}};  // whatever was in the list before is gone afterwards
    int changes = 0;
    for (int step = 0; step < steps; ++step) {
        move(step, boxes);
        const std::vector<Pair> expected = overlapping(boxes);
        for (std::size_t i = 0; i < warm.size(); ++i) {
            INFO(search_names()[i] << ", step " << step << ", " << boxes.size() << " boxes");
            warm[i]->find(boxes, found);
            REQUIRE(found == expected);
            make_search(search_names()[i])->find(boxes, found);
            REQUIRE(found == expected);
        }
        changes += expected != last;
        last = expected;
    }
    return changes;
}

Box square(double x, double y, double half) { return {x - half, y - half, x + half, y + half}; }

Box moved(const Box& b, double dx, double dy) { return {b.xmin + dx, b.ymin + dy, b.xmax + dx, b.ymax + dy}; }

/// Boxes of very different sizes anywhere in a square of side `extent`.
Boxes scattered(Random& random, int count, double extent) {
    Boxes boxes;
    for (int i = 0; i < count; ++i)
        boxes.push_back(
            square(extent * random.uniform(), extent * random.uniform(), 0.1 + 1.5 * std::pow(random.uniform(), 4)));
    return boxes;
}

/// Unit squares in columns and rows that share their edges: each touches its eight neighbours.
Boxes grid(int n) {
    Boxes boxes;
    for (int i = 0; i < n * n; ++i) boxes.push_back({i % n + 0.0, i / n + 0.0, i % n + 1.0, i / n + 1.0});
    return boxes;
}

}  // namespace

TEST_CASE("searches find the pairs of boxes that drift") {
    for (const double speed : {1e-4, 1e-2, 0.3}) {
        Random random(1);
        Boxes velocity;
        const int changes = follow(60, [&](int step, Boxes& boxes) {
            if (step == 0) boxes = scattered(random, 250, 12.0);
            for (Box& box : boxes) box = moved(box, speed * random.normal(), speed * random.normal());
        });
        CHECK(changes > 2);
    }
}

TEST_CASE("searches find the pairs of boxes that grow and shrink") {
    Random random(2);
    const int changes = follow(60, [&](int step, Boxes& boxes) {
        if (step == 0) boxes = scattered(random, 150, 10.0);
        for (Box& box : boxes) {
            const Box grown = box.grown(0.1 * (random.uniform() - 0.5));
            if (grown.xmin <= grown.xmax) box = grown;
        }
    });
    CHECK(changes > 50);
}

TEST_CASE("searches agree when most coordinates are equal to others") {
    Random random(3);
    const auto whole = [&](int n) { return static_cast<double>(random.bits() % n); };
    const int changes = follow(80, [&](int, Boxes& boxes) {
        boxes.resize(120);
        for (Box& box : boxes)
            if (box.xmax == 0.0 || random.uniform() < 0.2) {
                const double x = whole(12), y = whole(12);
                box = {x, y, x + whole(4), y + whole(4)};  // some are lines and points
            }
    });
    CHECK(changes > 70);
}

TEST_CASE("squares that touch at an edge or a corner are pairs") {
    for (const char* name : search_names()) {
        std::vector<Pair> pairs;
        make_search(name)->find(grid(3), pairs);
        CHECK(pairs.size() == 20);  // 12 edges, 8 corners
        make_search(name)->find(Boxes{square(0, 0, 1), square(2, 2, 1), square(2.0 + 1e-15, 4.0 + 1e-15, 1)}, pairs);
        CHECK(pairs == std::vector<Pair>{{0, 1}});
    }
}

TEST_CASE("squares of a grid part and touch again exactly") {
    const int changes = follow(40, [](int step, Boxes& boxes) {
        boxes = grid(12);
        const double gap = step % 2 == 0 ? 0.0 : 0x1p-40;
        for (std::size_t i = 0; i < boxes.size(); ++i)
            boxes[i] = moved(boxes[i], gap * (i % 12), gap * ((i / 12) % (step % 5 + 1)));
    });
    CHECK(changes == 40);
}

TEST_CASE("squares that coincide are pairs, all with all") {
    const int changes = follow(12, [](int step, Boxes& boxes) {
        boxes.assign(60, square(0, 0, 1));
        for (int i = 0; i < 60; ++i)
            if (step % 3 == 1)
                boxes[i] = moved(boxes[i], 3.0 * (i % (step + 1)), 0.0);  // heaps apart, then all in one again
    });
    CHECK(changes > 5);
    std::vector<Pair> pairs;
    make_search("isu")->find(Boxes(60, square(0, 0, 1)), pairs);
    CHECK(pairs.size() == 60 * 59 / 2);
}

TEST_CASE("a box inside another is a pair with it, whichever of them moves") {
    const int changes = follow(60, [](int step, Boxes& boxes) {
        boxes.clear();
        for (int i = 0; i < 40; ++i) boxes.push_back(square(0, 0, 0.5 + i % 20));  // nested, each size twice
        for (int i = 0; i < 10; ++i) boxes.push_back(square(25.0 - step + i, 5.0 * std::sin(0.3 * step + i), 0.2));
        boxes[39] = moved(boxes[39], 10.0 * step, 0.0);  // leaves them all
    });
    CHECK(changes > 40);
}

TEST_CASE("one huge box is a pair with every box it covers") {
    Random random(4);
    const int changes = follow(50, [&](int step, Boxes& boxes) {
        if (step == 0) boxes = scattered(random, 200, 20.0);
        for (Box& box : boxes) box = moved(box, 0.02 * random.normal(), 0.02 * random.normal());
        boxes[77] = step % 10 < 5 ? square(10.0 + step, 10.0, 100.0) : Box{-1e3, 4.0, 1e3, 4.0 + 0.2 * step};
        boxes[13] = step % 7 == 0 ? Box{-huge, -huge, huge, huge} : square(1.0, 1.0, 0.5);
    });
    CHECK(changes > 40);
}

TEST_CASE("joints along an axis, shuffled by rounding, change no pair of boxes with a skin") {
    Random random(5);
    const double skin = 0.02;
    const int changes = follow(30, [&](int, Boxes& boxes) {
        boxes = grid(14);
        for (Box& box : boxes) box = moved(box.grown(skin), 1e-9 * random.normal(), 1e-9 * random.normal());
    });
    CHECK(changes == 1);
}

TEST_CASE("joints along an axis, shuffled by rounding, part and touch box by box without a skin") {
    Random random(6);
    const int changes = follow(30, [&](int, Boxes& boxes) {
        boxes = grid(14);
        for (Box& box : boxes) box = moved(box, 1e-9 * random.normal(), 1e-9 * random.normal());
    });
    CHECK(changes == 30);
}

TEST_CASE("boxes that vanish have no pairs until they come back") {
    Random random(7);
    Boxes all;
    const int changes = follow(60, [&](int step, Boxes& boxes) {
        if (step == 0) all = scattered(random, 150, 8.0);
        for (Box& box : all) box = moved(box, 0.01 * random.normal(), 0.01 * random.normal());
        if (step % 4 != 1) boxes = all;  // else: as in the last step, some still absent
        for (Box& box : boxes)
            if (step % 4 == 0 && random.uniform() < 0.1) box = absent;
        if (step == 30) boxes.assign(150, absent);
        if (step == 40) boxes[0] = {0, 0, not_a_number, 1}, boxes[1].ymin = not_a_number;
    });
    CHECK(changes > 30);
}

TEST_CASE("an absent box overlaps nothing, wherever its numbers lie") {
    for (const char* name : search_names()) {
        const auto search = make_search(name);
        std::vector<Pair> pairs;
        search->find(Boxes{{0, 0, 1, 1}, absent, absent, {0.2, 0.2, 3, 3}}, pairs);
        CHECK(pairs == std::vector<Pair>{{0, 3}});
        search->find(Boxes{absent}, pairs);
        CHECK(pairs.empty());
    }
}

TEST_CASE("the number of boxes may change from call to call") {
    Random random(8);
    const int changes = follow(40, [&](int step, Boxes& boxes) {
        const int counts[] = {100, 101, 40, 0, 1, 2, 0, 160, 159, 159};
        const Boxes more = scattered(random, counts[step % 10], 6.0);
        boxes.resize(std::min(boxes.size(), more.size()));  // those that stay keep their place
        boxes.insert(boxes.end(), more.begin() + std::ssize(boxes), more.end());
    });
    CHECK(changes > 20);
}

TEST_CASE("boxes that all jump are found as if nothing had been remembered") {
    Random random(9);
    const int changes = follow(8, [&](int step, Boxes& boxes) {
        if (step % 4 != 3) boxes = scattered(random, 1500, 30.0);
        for (Box& box : boxes) box = moved(box, 1e-3 * random.normal(), 1e-3 * random.normal());  // calm again after a jump
    });
    CHECK(changes == 8);
}

TEST_CASE("boxes may lie in map coordinates, where their width is few digits") {
    for (const double offset : {1e7, -1e7, 1e15}) {
        Random random(10);
        const int changes = follow(30, [&](int step, Boxes& boxes) {
            if (step == 0)
                for (const Box& box : scattered(random, 150, 10.0)) boxes.push_back(moved(box, offset, -0.5 * offset));
            for (Box& box : boxes) box = moved(box, 0.3 * random.normal(), 0.3 * random.normal());
        });
        CHECK(changes > 20);
    }
}

TEST_CASE("boxes may be a thousand times as large as others, and change their size class") {
    Random random(11);
    const int changes = follow(40, [&](int step, Boxes& boxes) {
        if (step == 0)
            for (int i = 0; i < 300; ++i) {
                const double half = std::pow(10.0, -2.0 + 3.0 * std::pow(random.uniform(), 6));
                boxes.push_back(square(30.0 * random.uniform(), 30.0 * random.uniform(), half));
            }
        for (Box& box : boxes) {
            box = moved(box, 0.01 * random.normal(), 0.01 * random.normal());
            if (random.uniform() < 0.02) box = box.grown(0.5 * (box.xmax - box.xmin));          // twice as large
            if (random.uniform() < 0.04) box = box.grown(-0.25 * (box.xmax - box.xmin));        // half as large
            if (random.uniform() < 0.01) box.xmax = box.xmin + 1000.0 * (box.xmax - box.xmin);  // a needle
        }
    });
    CHECK(changes > 30);
}

TEST_CASE("boxes may be points, lines and small beside their coordinates") {
    Random random(12);
    const int changes = follow(30, [&](int, Boxes& boxes) {
        boxes.resize(200);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const double x = std::round(8.0 * random.uniform()), y = std::round(8.0 * random.uniform());
            const double width = i % 3 == 0 ? 0.0 : std::pow(10.0, -300.0 * random.uniform());
            boxes[i] = {x, y, x + width, y + (i % 2 == 0 ? 0.0 : std::round(3.0 * random.uniform()))};
        }
    });
    CHECK(changes == 30);
}

TEST_CASE("boxes may lie where coordinates come to their end") {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    Random random(13);
    const int changes = follow(40, [&](int step, Boxes& boxes) {
        if (step == 0) boxes = scattered(random, 120, 8.0);
        for (Box& box : boxes) box = moved(box, 0.05 * random.normal(), 0.05 * random.normal());
        for (int i = 0; i < 20; ++i) {
            const double far = std::pow(10.0, 15.0 * (i + 1)) * (i % 2 == 0 ? 1.0 : -1.0);  // up to 1e300
            boxes[i] = {far, -std::abs(far), far + 0.3 * std::abs(far), std::abs(far) * random.uniform()};
        }
        boxes[20] = {-huge, 0.1 * step, huge, 0.1 * step};
        boxes[21] = step % 3 == 0 ? Box{-infinite, -infinite, infinite, infinite} : Box{0.0, 0.0, 1.0, infinite};
        boxes[22] = step % 2 == 0 ? Box{infinite, 0.0, infinite, 1.0} : Box{-infinite, 0.0, -infinite, huge};
    });
    CHECK(changes > 30);
}

TEST_CASE("one wall beside all blocks, and blocks in one row or column, are swept like any others") {
    const int changes = follow(12, [&](int step, Boxes& boxes) {
        boxes.clear();
        for (int i = 0; i < 400; ++i) {
            const double along = i + 0.1 * (step % 3), across = 0.01 * (i * step % 7);
            boxes.push_back(step % 2 == 0 ? square(along, across, 0.51) : square(across, along, 0.51));
        }
        boxes.push_back(step % 4 < 2 ? Box{-1.0, -1.0, 401.0, -0.5} : Box{-1.0, -1.0, -0.5, 401.0});
    });
    CHECK(changes > 10);
}

namespace {

/// Boxes in a pile that is stirred: each moves by a percent of its size per step, some by more.
void stir(Random& random, Boxes& boxes) {
    for (Box& box : boxes) {
        const double by = 0.02 * (box.xmax - box.xmin) * (random.uniform() < 0.01 ? 20.0 : 1.0);
        box = moved(box, by * random.normal(), by * random.normal());
    }
}

void allow_threads([[maybe_unused]] int threads) {
#ifdef _OPENMP
    omp_set_num_threads(threads);
#endif
}

}  // namespace

TEST_CASE("the number of threads changes no pair and no count of exchanges") {
    for (const char* name : search_names()) {
        std::vector<std::vector<Pair>> first;
        std::int64_t exchanges = 0;
        for (const int threads : {1, 2, 3, 8}) {
            allow_threads(threads);
            Random random(14);
            Boxes boxes = scattered(random, 3000, 60.0);
            const auto search = make_search(name);
            for (int step = 0; step < 12; ++step) {
                INFO(name << ", " << threads << " threads, step " << step);
                if (step == 9) std::swap_ranges(boxes.begin(), boxes.begin() + 1500, boxes.begin() + 1500);  // all jump
                std::vector<Pair> found;
                search->find(boxes, found);
                if (threads == 1) first.push_back(found);
                REQUIRE(found == first[step]);
                stir(random, boxes);
            }
            if (threads == 1) exchanges = search->exchanges();
            CHECK(search->exchanges() == exchanges);
        }
        CHECK(first.front() != first.back());
    }
    allow_threads(1);
}

TEST_CASE("many boxes in fast motion give the same pairs with every search") {
    allow_threads(3);
    Random random(15);
    Boxes boxes = scattered(random, 20000, 150.0);
    std::vector<std::unique_ptr<PairSearch>> warm;
    for (const char* name : search_names()) warm.push_back(make_search(name));
    std::size_t changes = 0;
    for (int step = 0; step < 4; ++step) {
        std::vector<Pair> expected, found;
        warm.front()->find(boxes, expected);
        for (std::size_t i = 1; i < warm.size(); ++i) {
            INFO(search_names()[i] << ", step " << step);
            warm[i]->find(boxes, found);
            REQUIRE(found == expected);
        }
        changes += expected.size() > 20000;
        stir(random, boxes);
    }
    CHECK(changes == 4);
    allow_threads(1);
}

TEST_CASE("exchanges are counted: two ends that pass each other are one") {
    for (const char* name : {"isu", "isu-separated", "isu-parallel", "dess"}) {
        const auto search = make_search(name);
        std::vector<Pair> pairs;
        search->find(Boxes{{0, 0, 1, 1}, {2, 3, 4, 5}}, pairs);
        CHECK(search->exchanges() == 0);
        search->find(Boxes{{0, 0, 1, 1}, {0.5, 3, 4, 5}},
                     pairs);  // along x: the lower end of one passes the upper of the other
        CHECK(search->exchanges() == 1);
        search->find(Boxes{{0, 0, 1, 1}, {-0.5, 0.5, 0.5, 5}},
                     pairs);  // x: its lower end the lower one, its upper end the upper one; y: as above
        CHECK(search->exchanges() == 4);
        CHECK(pairs == std::vector<Pair>{{0, 1}});
        search->find(Boxes{{0, 0, 1, 1}, {-0.5, 0.5, 0.5, 5}}, pairs);
        CHECK(search->exchanges() == 4);
    }
}

TEST_CASE("auto goes from safe regions to lists and back as the motion asks, without a wrong pair") {
    for (const int count : {400, 3000}) {
        Random random(14);
        Boxes boxes = scattered(random, count, std::sqrt(static_cast<double>(count)));
        const auto search = make_search("auto"), reference = make_search("dess-fused");
        std::vector<Pair> found, expected;
        std::vector<std::string> ways;
        for (int step = 0; step < 700; ++step) {
            const double speed = step < 80 || step >= 170 ? 1e-7 : count == 400 ? 0.03 : 0.3;
            for (Box& box : boxes) box = moved(box, speed * random.normal(), speed * random.normal());
            search->find(boxes, found);
            reference->find(boxes, expected);
            INFO("step " << step << " of " << count << " boxes, " << search->choice());
            REQUIRE(found == expected);
            const std::string way = search->choice().substr(0, search->choice().find(','));
            if (ways.empty() || ways.back() != way) ways.push_back(way);
        }
        CHECK(ways == std::vector<std::string>{"safe regions", "Verlet lists", "safe regions"});
    }
}

TEST_CASE("an unknown search is refused with the names allowed and the nearest of them") {
    CHECK_THROWS_AS(make_search("octree"), InputError);
    CHECK_THROWS_WITH(make_search("octree"), Catch::Contains("\"octree\"") && Catch::Contains("dess dess-fused direct") &&
                                                 !Catch::Contains("did you mean"));
    CHECK_THROWS_WITH(make_search("des"), Catch::Contains("did you mean dess?"));
    CHECK_THROWS_WITH(make_search("dirct"), Catch::Contains("did you mean direct?"));
    CHECK_THROWS_WITH(make_search("isu-paralel"), Catch::Contains("did you mean isu-parallel?"));
}

TEST_CASE("every documented search can be made, and is its own") {
    REQUIRE(search_names().size() >= 8);
    std::set<std::string> names;
    for (const char* name : search_names()) {
        CHECK(make_search(name) != nullptr);
        names.insert(name);
    }
    CHECK(names.size() == search_names().size());
}
