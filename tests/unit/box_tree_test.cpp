#include "geometry/box_tree.hpp"

#include "core/random.hpp"
#include "support/catch.hpp"

#include <algorithm>

using namespace talus;

TEST_CASE("a tree of boxes finds what comparing all boxes finds, each once") {
    Random random(5);
    std::vector<Box> boxes;
    for (int i = 0; i < 300; ++i) {  // sizes from points to a third of the domain, on a coarse grid so that many only touch
        const double size = std::floor(std::pow(random.uniform(), 6.0) * 30.0), x = std::floor(random.uniform() * 90.0),
                     y = std::floor(random.uniform() * 90.0);
        boxes.push_back({x, y, x + size, y + size / 2});
    }
    for (int i = 0; i < 20; ++i) boxes.push_back({45, 45, 46, 46});  // and some equal ones
    const BoxTree tree(boxes);
    for (const Box& query : boxes) {
        std::vector<int> found, expected;
        tree.overlapping(query, [&](int i) { found.push_back(i); });
        std::sort(found.begin(), found.end());
        for (int i = 0; i < static_cast<int>(boxes.size()); ++i)
            if (boxes[i].overlaps(query)) expected.push_back(i);
        CHECK(found == expected);
    }
}

TEST_CASE("an empty tree of boxes finds nothing") {
    int found = 0;
    BoxTree({}).overlapping({0, 0, 1, 1}, [&](int) { ++found; });
    CHECK(found == 0);
}
