// Boxes that are kept for several steps: when blocks have left them, and which get new ones.
#include "model/part_boxes.hpp"
#include "core/random.hpp"
#include "dynamics/motion.hpp"
#include "model/build.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

#include <limits>

using namespace talus;
using namespace talus::scenes;

namespace {

constexpr double skin = 0.1;  // m

// A square of 2 m, its corners sqrt(2) m from the centroid, and a triangle far from it.
struct Boxes {
    Scene scene =
        build(with({block("square", {{0, 0}, {2, 0}, {2, 2}, {0, 2}}), block("triangle", {{9, 0}, {10, 0}, {9, 1}})}));
    Placed placed;
    std::vector<Box> boxes;
    std::vector<std::uint8_t> reboxed;

    Boxes() {
        place_all();
        renew();
    }
    bool place_all() { return place(scene.model, scene.state.motion, skin, placed); }
    int renew() { return rebox(scene.model, scene.state, skin, placed, boxes, reboxed); }
    Motion& motion() { return scene.state.motion; }
};

bool same(const Box& a, const Box& b) {
    return a.xmin == b.xmin && a.ymin == b.ymin && a.xmax == b.xmax && a.ymax == b.ymax;
}

}  // namespace

TEST_CASE("there are no boxes at first; then every part has one, larger by the skin") {
    Boxes b;
    Placed none;
    CHECK(place(b.scene.model, b.motion(), skin, none));
    CHECK_FALSE(b.place_all());
    REQUIRE(b.boxes.size() == 2);
    CHECK(b.boxes[0].xmax - b.boxes[0].xmin == Approx(2.0 + 2.0 * skin));
    CHECK(b.boxes[1].ymax - b.boxes[1].ymin == Approx(1.0 + 2.0 * skin));
}

TEST_CASE("a block has left its box when it moved and turned, together, by more than the skin") {
    const auto left = [](double dx, double dy, double turn) {
        Boxes b;
        b.motion().position[0] += Vec2(dx, dy);
        b.motion().angle[0] += turn;
        return b.place_all();
    };
    const double radius = std::sqrt(2.0);
    CHECK_FALSE(left(0.999 * skin, -0.999 * skin, 0.0));  // along each axis
    CHECK(left(1.001 * skin, 0.0, 0.0));
    CHECK(left(0.0, -1.001 * skin, 0.0));
    CHECK_FALSE(left(0.0, 0.0, 0.999 * skin / radius));
    CHECK(left(0.0, 0.0, -1.001 * skin / radius));
    CHECK_FALSE(left(0.5 * skin, 0.0, 0.499 * skin / radius));
    CHECK(left(0.5 * skin, 0.0, 0.501 * skin / radius));
    CHECK(left(std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0));
}

TEST_CASE("only blocks that left their boxes, or soon will, get new ones") {
    Boxes b;
    const std::vector<Box> before = b.boxes;
    b.motion().position[0].x() += 1.5 * skin;
    b.motion().position[1].x() += 0.9 * kept_share * skin;
    CHECK(b.place_all());
    CHECK(b.renew() == 1);
    CHECK(b.reboxed == std::vector<std::uint8_t>{1, 0});
    CHECK(b.boxes[0].xmin == Approx(before[0].xmin + 1.5 * skin));
    CHECK(same(b.boxes[1], before[1]));
    CHECK_FALSE(b.place_all());
    b.motion().position[0].x() += 1.1 * skin;
    b.motion().position[1].x() += 0.2 * kept_share * skin;  // counts from its own boxes: 1.1 of the share
    CHECK(b.place_all());
    CHECK(b.renew() == 2);
}

TEST_CASE("every part stays within its box as long as no block is said to have left") {
    Random random(3);
    Boxes b;
    int kept = 0, renewed = 0;
    for (int step = 0; step < 2000; ++step) {
        for (BlockId k = 0; k < 2; ++k) {
            b.motion().position[k] += 0.1 * skin * Vec2(random.uniform() - 0.5, random.uniform() - 0.5);
            b.motion().angle[k] += 0.2 * skin * (random.uniform() - 0.5);
        }
        if (b.place_all()) renewed += b.renew();
        std::vector<Box> now;
        part_boxes(b.scene.model, b.scene.state, b.placed, now);
        for (PartId p = 0; p < 2; ++p) {
            kept += !b.reboxed[p];
            REQUIRE(b.boxes[p].grown(1e-12).contains(now[p]));
        }
    }
    CHECK(kept > 100);
    CHECK(renewed > 10);
}
