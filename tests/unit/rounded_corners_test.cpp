// Corners rounded as in the classical distinct element method, against what the drawing of two arcs and a line says.
#include "contact/rounded_corners.hpp"

#include "core/random.hpp"
#include "dynamics/motion.hpp"
#include "dynamics/time_step.hpp"
#include "model/build.hpp"
#include "model/rounding.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace talus;
using namespace talus::scenes;

namespace {

constexpr double rounding = 0.02;  // m; that is the radius too where edges meet at right angles

Scenario rounded(Scenario scene) {
    scene.run.rounding_length = rounding;
    return scene;
}

struct RoundedBlocks {
    Scene scene;
    Placed placed;

    RoundedBlocks(const Polygon& a, const Polygon& b)
        : scene(build(rounded(with({block("a", a), block("b", shifted(b, {100.0, 0.0}))})))) {
        put(1, scene.state.motion.position[1] - Vec2(100.0, 0.0), 0.0);
    }
    void put(BlockId b, const Vec2& at, double angle) {
        scene.state.motion.position[b] = at;
        scene.state.motion.angle[b] = angle;
        place(scene.model, all_awake(2), scene.state.motion, 0.0, placed);
    }
    Vec2 way(int from, int to) const { return scene.state.motion.position[to] - scene.state.motion.position[from]; }
    Pressed contact(int a = 0, int b = 1) const {
        const Vec2 d = way(a, b);
        return rounded_contact(scene.model, {scene.model, placed, a}, {scene.model, placed, b}, d.x(), d.y());
    }
};

Vec2 turned(const Vec2& v, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

}  // namespace

TEST_CASE("a rounded corner on an edge is one spring along the normal of the edge, where the arc is deepest") {
    const double angle = 0.2, u = 1e-5;
    RoundedBlocks pair(rectangle(-5, -1, 5, 0), rectangle(-0.5, 0, 0.5, 2));
    const Vec2 to_arc = turned({-0.5 + rounding, -1.0 + rounding}, angle);  // the lower left one stays lowest if turned back
    const Vec2 other = turned({0.5 - rounding, -1.0 + rounding}, angle);
    REQUIRE(to_arc.y() < other.y());
    pair.put(1, Vec2(0.3, rounding - u - to_arc.y()), angle);
    const Pressed p = pair.contact();
    // The foot and the left side face the ground with cos and sin of their lengths, weighted with the 8th power of both.
    const double foot = std::cos(angle), side = 2.0 * std::sin(angle);
    const double length = 0.5 * (foot * std::pow(std::cos(angle), 8) + side * std::pow(std::sin(angle), 8));
    CHECK(p.length == Approx(length).epsilon(1e-10));
    CHECK(p.fx == Approx(0.0).margin(1e-15));
    CHECK(p.fy == Approx(length * u).epsilon(1e-9));
    CHECK(p.torque_b == Approx(to_arc.x() * p.fy).epsilon(1e-9));
    CHECK(p.x == Approx(0.3 + to_arc.x()).epsilon(1e-12));
    CHECK(p.y == Approx(0.5 - 0.5 * u).epsilon(1e-12));  // half-way into the overlap, from the middle of a
}

TEST_CASE("tip against tip, rounded corners push each other along the line of their centres") {
    const double half = std::sqrt(0.5), u = 1e-5;
    for (const double offset : {0.0, 1e-3, 0.01}) {
        RoundedBlocks pair(rectangle(0, 0, 1, 1), rectangle(0, 0, 1, 1));
        const double quarter = std::acos(-1.0) / 4.0, to_centre = half - std::sqrt(2.0) * rounding;
        const double along = std::sqrt(std::pow(2.0 * rounding - u, 2) - offset * offset);
        pair.put(0, {0.0, 0.0}, quarter);
        pair.put(1, {2.0 * to_centre + along, offset}, quarter);
        const Pressed p = pair.contact();
        REQUIRE(p.loaded());
        CHECK(p.overlap == Approx(u).epsilon(1e-9));
        CHECK(p.fy / p.fx == Approx(offset / along).margin(1e-12));
        // The force goes through both centres.
        CHECK(p.torque_a == Approx(to_centre * p.fy).margin(1e-15));
        CHECK(p.torque_b == Approx(-to_centre * p.fy).margin(1e-15));
    }
}

TEST_CASE("a face on rounded corners carries kn u per metre, and resists rotation as two springs at its ends do") {
    const double u = 1e-4, tilt = 1e-6;
    RoundedBlocks pair(rectangle(-5, -1, 5, 0), rectangle(-1, 0, 1, 1));
    pair.put(1, Vec2(0.0, 0.5 - u), tilt);
    const Pressed p = pair.contact();
    CHECK(p.length == Approx(2.0).epsilon(1e-9));
    CHECK(p.fy == Approx(2.0 * u).epsilon(1e-7));
    CHECK(p.torque_b == Approx(-2.0 * std::pow(1.0 - rounding, 2) * tilt).epsilon(1e-3));
    CHECK(p.rotation_stiffness == Approx(2.0 * std::pow(1.0 - rounding, 2)).epsilon(1e-6));
}

TEST_CASE("where tips pass above each other the force of rounded corners does not jump, tilted or not") {
    for (const double tilt : {0.0, 0.003, -0.003, 0.05, -0.05}) {
        RoundedBlocks pair(rectangle(0, 0, 1, 1), rectangle(0, 1, 1, 2));
        const double lowest = 0.5 * std::cos(tilt) + 0.5 * std::abs(std::sin(tilt));  // of the sharp block, from its middle
        const double step = 1e-6;
        double before = 0.0, largest = 0.0, jump = 0.0;
        for (int i = -60000; i <= 60000; ++i) {
            pair.put(1, Vec2(0.5 + step * i, 0.5 + 0.5 + lowest - 0.003 * (1.0 + std::abs(tilt) * 20.0)), tilt);
            const Pressed p = pair.contact();
            const double size = std::hypot(p.fx, p.fy);
            if (i > -60000) jump = std::max(jump, std::abs(size - before));
            largest = std::max(largest, size);
            before = size;
        }
        CAPTURE(tilt, largest, jump);
        CHECK(largest > 1e-4);
        CHECK(jump < 1e-3 * largest);  // two springs in place of one would make it 1
    }
}

TEST_CASE("rounded corners do to b the opposite of what they do to a, and a mirror changes no more than signs") {
    Random random(5);
    int loaded = 0;
    for (int trial = 0; trial < 300; ++trial) {
        const auto polygon = [&](int corners) {
            Polygon all;
            for (int i = 0; i < corners; ++i) {
                const double angle = 2.0 * std::numbers::pi * (i + 0.6 * random.uniform()) / corners;
                all.emplace_back(std::cos(angle), std::sin(angle));
            }
            return all;
        };
        const Polygon a = polygon(3 + trial % 4), b = shifted(polygon(3 + trial % 3), {1.7, 0.3});
        const auto mirrored = [](const Polygon& outline) {
            Polygon image;
            for (auto p = outline.rbegin(); p != outline.rend(); ++p) image.emplace_back(-p->x(), p->y());
            return image;
        };
        const RoundedBlocks pair(a, b), image(mirrored(a), mirrored(b));
        const Pressed p = pair.contact(), swapped = pair.contact(1, 0), seen = image.contact();
        CHECK(p.loaded() == swapped.loaded());
        if (!p.loaded()) continue;
        ++loaded;
        const Vec2 d = pair.way(0, 1);
        const double size = std::hypot(p.fx, p.fy);
        CHECK(swapped.fx == Approx(-p.fx).margin(1e-10 * size));
        CHECK(swapped.fy == Approx(-p.fy).margin(1e-10 * size));
        CHECK(swapped.torque_b == Approx(-p.torque_a).margin(1e-10 * size));
        CHECK(p.torque_a == Approx(p.torque_b + d.x() * p.fy - d.y() * p.fx).margin(1e-10 * size));
        CHECK(seen.fx == Approx(-p.fx).margin(1e-9 * size));
        CHECK(seen.torque_b == Approx(-p.torque_b).margin(1e-9 * size));
    }
    CHECK(loaded > 100);
}

TEST_CASE("circles of rounded corners lie within the block: short edges, slivers and flat corners are rounded by less") {
    Random random(3);
    std::vector<Polygon> outlines{
        rectangle(0, 0, 3, 0.01), {{0, 0}, {2, 0}, {1, 0.005}}, {{0, 0}, {1, 0}, {1.001, 1e-4}, {1, 1}}};
    for (int trial = 0; trial < 50; ++trial) {
        Polygon outline;
        for (int i = 0; i < 3 + trial % 5; ++i) {
            const double angle = 2.0 * std::numbers::pi * (i + 0.9 * random.uniform()) / (3 + trial % 5);
            outline.emplace_back(0.3 * std::cos(angle), 0.02 * std::sin(angle));
        }
        outlines.push_back(outline);
    }
    for (const Polygon& outline : outlines) {
        const Model model = build(rounded(with({block("a", outline)}))).model;
        const Corners& c = model.corners;
        for (int k = 0; k < c.size(); ++k) {
            const int before = (k + c.size() - 1) % c.size();
            const CornerArc arc = corner_arc(c.normal[before], c.normal[k], c.cut[k]);
            const Vec2 centre = c.arm[k] + arc.cut * perp(c.normal[k]) - arc.radius * c.normal[k];
            CAPTURE(k, c.cut[k], arc.radius);
            CHECK(c.cut[k] <= rounding);
            CHECK(c.offset[before] - c.normal[before].dot(centre) == Approx(arc.radius).margin(1e-12));
            for (int j = 0; j < c.size(); ++j) CHECK(c.offset[j] - c.normal[j].dot(centre) > arc.radius - 1e-12);
        }
    }
}

TEST_CASE("springs at its corners leave a block less of a time step than a joint along its faces") {
    // Rotation of a square of side L and mass m: four faces of kn L^3/12, and as much again from sliding arms; with springs
    // at the corners three times the former.
    Scenario scene = with({block("a", rectangle(0, 0, 1, 1)), block("b", rectangle(3, 0, 4, 1))});
    scene.joints[0].shear_stiffness = 1e-6 * scene.joints[0].normal_stiffness;
    const auto bound = [&](std::optional<double> length) {
        scene.run.rounding_length = length;
        Scene built = build(scene);
        Placed placed;
        place(built.model, all_awake(2), built.state.motion, 0.0, placed);
        return stable_step(built.model, placed, built.state).bound;
    };
    // Along each axis 2 kn L / m; rotation 4 kn L^3/12 / (m L^2/6) = 2 kn L / m with even stiffness, 6 kn L / m with
    // springs.
    CHECK(bound(1e-9) == Approx(bound({}) / std::sqrt(3.0)).epsilon(1e-4));
}
