#include "contact/near_boxes.hpp"
#include "core/random.hpp"
#include "support/catch.hpp"

#include <limits>

using namespace talus;

TEST_CASE("every vector unit finds the same boxes near, those that touch included and no numbers left out") {
    Random random(1);
    const auto whole = [&](int n) { return static_cast<double>(random.bits() % n); };
    RoundedBoxes boxes;
    std::vector<Box> exact;
    for (int i = 0; i < 200; ++i) {
        const double x = whole(12), y = whole(12);
        exact.push_back({x, y, x + whole(4), y + whole(4)});
        if (i % 17 == 0) exact.back().ymax = std::numeric_limits<double>::quiet_NaN();
    }
    boxes.resize(exact.size());
    for (std::size_t i = 0; i < exact.size(); ++i) boxes.set(i, exact[i]);

    for (int place = 0; place < 200; place += 3)
        for (const int length : {0, 1, 7, 8, 15, 16, 17, 33, 90}) {
            const int from = static_cast<int>(random.bits() % 110), to = from + length;
            std::vector<int> near, near_along_y;
            for (int k = from; k < to; ++k) {
                const Box &a = exact[place], &b = exact[k];
                if (a.overlaps(b)) near.push_back(k);
                if (a.ymin <= b.ymax && b.ymin <= a.ymax) near_along_y.push_back(k);
            }
            for (const VectorUnit unit : {VectorUnit::baseline, VectorUnit::avx2, VectorUnit::avx512}) {
                if (!has(unit)) continue;
                const auto found_by = [&](FindNear find) {
                    std::vector<int> found(length + 16);
                    found.resize(find(boxes, place, from, to, found.data()));
                    return found;
                };
                CAPTURE(place, from, length, static_cast<int>(unit));
                CHECK(found_by(near_kernel(unit)) == near);
                CHECK(found_by(rarely_near_kernel(unit)) == near);
                CHECK(found_by(near_along_y_kernel(unit)) == near_along_y);
            }
        }
}
