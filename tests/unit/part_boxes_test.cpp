// Boxes that are kept for several steps: when blocks have left them, and which get new ones.
#include "model/part_boxes.hpp"
#include "core/random.hpp"
#include "dynamics/motion.hpp"
#include "model/build.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

#include <cmath>
#include <limits>
#include <numbers>

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

    explicit Boxes(const Vec2& axis = Vec2::UnitX()) {
        scene.model.box_axis = axis;
        place_all();
        renew();
    }
    bool place_all() { return place(scene.model, all_awake(2), scene.state.motion, skin, placed); }
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
    CHECK(place(b.scene.model, all_awake(2), b.motion(), skin, none));
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
    const double turned = GENERATE(0.0, 0.3);  // rad
    Boxes b(Vec2(std::cos(turned), std::sin(turned)));
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

TEST_CASE("boxes along turned axes are those of the turned parts") {
    const double angle = 0.3;
    const Boxes b(Vec2(std::cos(angle), std::sin(angle)));
    const double side = 2.0 * (std::cos(angle) + std::sin(angle)) + 2.0 * skin;
    CHECK(b.boxes[0].xmax - b.boxes[0].xmin == Approx(side));
    CHECK(b.boxes[0].ymax - b.boxes[0].ymin == Approx(side));
    CHECK(0.5 * (b.boxes[0].xmin + b.boxes[0].xmax) == Approx(std::cos(angle) + std::sin(angle)));
    CHECK(0.5 * (b.boxes[0].ymin + b.boxes[0].ymax) == Approx(std::cos(angle) - std::sin(angle)));
}

TEST_CASE("axes of boxes turn away from edges along x and y, and from nothing else") {
    const auto axis_deg = [](double first_deg, double second_deg, double length) {  // a parallelogram
        const auto side = [](double deg, double size) {
            const double angle = deg * std::numbers::pi / 180.0;
            return Vec2(size * std::cos(angle), size * std::sin(angle));
        };
        const Vec2 a = side(first_deg, length), b = side(second_deg, 1.0);
        const Scene scene = build(with({block("sheared", {Vec2(0, 0), a, Vec2(a + b), b})}));
        return std::atan2(scene.model.box_axis.y(), scene.model.box_axis.x()) * 180.0 / std::numbers::pi;
    };
    CHECK(axis_deg(17.0, 107.0, 1.0) == 0.0);
    CHECK(axis_deg(-45.0, 45.0, 1.0) == 0.0);
    CHECK(axis_deg(4.0, 80.0, 1.0) == 0.0);
    for (const double deg : {0.0, 1.0, -2.0, 90.0}) {
        const double turned = axis_deg(deg, deg + 90.0, 3.0);
        CHECK(std::abs(turned - deg + (deg == 90.0 ? 90.0 : 0.0)) > 2.5);
        CHECK(std::abs(turned) < 8.0);  // boxes grow with it
    }
    CHECK(std::abs(axis_deg(0.0, 60.0, 1.0)) > 2.5);
    CHECK(axis_deg(30.0, 90.0, 500.0) == 0.0);  // hardly any of it lies along y
}
