#include "contact/contacts.hpp"
#include "contact/distance_potential.hpp"
#include "contact/face_path.hpp"
#include "contact/idle.hpp"
#include "contact/law.hpp"
#include "contact/separation.hpp"
#include "core/random.hpp"
#include "dynamics/motion.hpp"
#include "model/build.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace talus;
using namespace talus::scenes;

namespace {

// Two free blocks, placed where the test wants them.
struct TwoBlocks {
    Scene scene;
    Placed placed;

    TwoBlocks(const Polygon& a, const Polygon& b)
        : scene(build(with({block("a", a), block("b", shifted(b, {100.0, 0.0}))}))) {
        put(1, scene.state.motion.position[1] - Vec2(100.0, 0.0), 0.0);
    }
    void put(BlockId b, const Vec2& at, double angle) {
        scene.state.motion.position[b] = at;
        scene.state.motion.angle[b] = angle;
        place(scene.model, all_awake(scene.model.blocks.size()), scene.state.motion, 0.0, placed);
    }
    PlacedPart part(int i) const { return {scene.model, placed, i}; }
    Vec2 distance() const { return scene.state.motion.position[1] - scene.state.motion.position[0]; }
    Pressed general() const { return distance_potential(part(0), part(1), distance().x(), distance().y()); }
    double energy() const { return distance_potential_energy(part(0), part(1), distance().x(), distance().y()); }
    FaceContact face() const {  // along the edges that face each other across the least overlap
        const Separation s = separation(part(0), part(1), distance().x(), distance().y());
        const Vec2 n = part(s.of_a ? 0 : 1).normal(s.edge);
        const int other = facing_edge(part(s.of_a ? 1 : 0), n.x(), n.y());
        return face_contact(part(0), part(1), distance().x(), distance().y(), s.of_a ? s.edge : other,
                            s.of_a ? other : s.edge, nullptr);
    }
};

Polygon random_convex(Random& random, int corners, double radius) {
    Polygon polygon;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2.0 * std::numbers::pi * (i + 0.7 * random.uniform()) / corners;
        polygon.push_back(radius * Vec2(std::cos(angle), std::sin(angle)));
    }
    return polygon;
}

}  // namespace

TEST_CASE("the force of the distance potential is the gradient of its energy, its torque the derivative by rotation") {
    Random random(7);
    int loaded = 0;
    for (int trial = 0; trial < 200; ++trial) {
        TwoBlocks pair(random_convex(random, 3 + trial % 4, 1.0), random_convex(random, 3 + trial % 3, 0.8));
        const Vec2 at = pair.scene.state.motion.position[0] + Vec2(1.2 * random.uniform(), 1.2 * random.uniform() - 0.3);
        const double angle = random.uniform();
        pair.put(1, at, angle);
        const Pressed patch = pair.general();
        if (!patch.loaded()) continue;
        ++loaded;
        const double h = 1e-6;
        const auto slope = [&](const Vec2& by, double turn) {
            pair.put(1, at + h * by, angle + h * turn);
            const double up = pair.energy();
            pair.put(1, at - h * by, angle - h * turn);
            return (up - pair.energy()) / (2.0 * h);
        };
        const double scale = std::hypot(patch.fx, patch.fy) + 1e-6;
        CHECK(std::abs(patch.fx + slope({1.0, 0.0}, 0.0)) < 1e-5 * scale);
        CHECK(std::abs(patch.fy + slope({0.0, 1.0}, 0.0)) < 1e-5 * scale);
        CHECK(std::abs(patch.torque_b + slope({0.0, 0.0}, 1.0)) < 1e-5 * scale);
        const Vec2 d = at - pair.scene.state.motion.position[0];
        CHECK(patch.torque_a == Approx(patch.torque_b + d.x() * patch.fy - d.y() * patch.fx).margin(1e-12));
    }
    CHECK(loaded > 100);
}

TEST_CASE("a block pressed flat on a wide one carries kn u per metre, whichever path computes it") {
    const double u = 1e-5;
    TwoBlocks pair(rectangle(-5, -1, 5, 0), rectangle(-1, -u, 1, 1 - u));
    const Pressed general = pair.general();
    REQUIRE(pair.face().state == FaceState::loaded);
    const Pressed face = pair.face().pressed;
    CHECK(face.fy == Approx(2.0 * u).epsilon(1e-9));
    CHECK(general.fy == Approx(2.0 * u).epsilon(2.0 * u));
    CHECK(std::abs(face.fx) < 1e-12 * u);
    CHECK(std::abs(general.fx) < 1e-12 * u);
    CHECK(face.x == Approx(general.x).margin(1e-9));
    CHECK(face.length == Approx(2.0).epsilon(1e-12));
}

TEST_CASE("tilt under an eccentric load follows the Winkler joint, with and without uplift") {
    // tilt kn L^2 / N = 12 e/L for e <= L/6, else 2 / (9 (1/2 - e/L)^2)
    for (const bool turned : {false, true}) {  // which of the two is the wide one
        for (const double u_mean : {3e-5, 1e-6}) {
            const double tilt = 2e-5;
            const Polygon wide = rectangle(-5, -1, 5, 0), block = rectangle(-0.5, 0, 0.5, 1);
            TwoBlocks pair(turned ? block : wide, turned ? wide : block);
            const int b = turned ? 0 : 1;
            pair.put(b, Vec2(0.0, 0.5 - u_mean), tilt);
            const double sign = turned ? -1.0 : 1.0;
            for (const bool general : {false, true}) {
                const Pressed patch = general ? pair.general() : pair.face().pressed;
                REQUIRE(patch.loaded());
                const double force = sign * patch.fy;
                const double torque = turned ? -patch.torque_a : patch.torque_b;  // on the block about its centroid
                // The base turns about the centre of the block: its overlap at x is u_mean - tilt x, so the left side
                // presses.
                const double e = -torque / force;
                const double expected =
                    std::abs(e) <= 1.0 / 6.0 ? 12.0 * std::abs(e) : 2.0 / (9.0 * std::pow(0.5 - std::abs(e), 2));
                CHECK(tilt / force == Approx(expected).epsilon(5e-4));
                // A block that stands on a wide face feels no force along that face, however it is tilted.
                CHECK(std::abs(patch.fx) < 2e-9 * force);
            }
        }
    }
}

TEST_CASE("at the overhanging ends of two bricks the face path pushes as the potential does") {
    const double u = 2e-5;
    for (const double shift : {0.7, -0.7}) {
        TwoBlocks pair(rectangle(-1, -1, 1, 0), shifted(rectangle(-1, 0, 1, 1), {shift, -u}));
        CHECK(pair.face().pressed.fx == Approx(pair.general().fx).epsilon(1e-3));
        CHECK(pair.face().pressed.fx * shift > 0.0);  // less overlap is less energy
    }
    TwoBlocks flush(rectangle(-1, -1, 1, 0), shifted(rectangle(-1, 0, 1, 1), {0.0, -u}));
    CHECK(std::abs(flush.face().pressed.fx) < 1e-15);
}

TEST_CASE("parts that an edge separates do nothing to each other, and the hint does not decide") {
    TwoBlocks pair(rectangle(-1, -1, 1, 0), shifted(rectangle(-1, 0, 1, 1), {2.0, 0.0}));  // meet in one corner only
    CHECK(separation(pair.part(0), pair.part(1), pair.distance().x(), pair.distance().y()).distance >= 0.0);
    CHECK_FALSE(pair.general().loaded());
}

TEST_CASE(
    "an idle pair is passed over only while the edge that kept it apart still does, however blocks move within reach") {
    Random random(3);
    const auto around = [&](double by) { return by * (2.0 * random.uniform() - 1.0); };
    int never = 0, quick = 0, touching = 0, passed_over = 0;
    for (int trial = 0; trial < 3000; ++trial) {
        const double size = std::pow(10.0, around(1.0));
        TwoBlocks pair(random_convex(random, 3 + trial % 4, 1.0), random_convex(random, 3 + trial % 3, size));
        const Model& model = pair.scene.model;
        const Vec2 at_a = pair.scene.state.motion.position[0];
        const double way = (1.0 + size) * (0.6 + 0.5 * random.uniform()), to = 6.3 * random.uniform();
        const Vec2 at_b = at_a + way * Vec2(std::cos(to), std::sin(to));
        const double angle_b = around(3.0);
        pair.put(1, at_b, angle_b);
        const Vec2 d = pair.distance();
        const Separation apart = separation(pair.part(0), pair.part(1), d.x(), d.y());
        if (apart.distance < 0.0) continue;
        const double reach = 0.1 * random.uniform() * std::min(1.0, size);
        Apart kept = keep_apart(model, pair.placed, 0, 1, apart, reach);
        for (int i = 0; i < 10; ++i) {  // each block moves by what the skin allows: both axes and the turn together
            for (const BlockId b : {0, 1}) {
                const double share = random.uniform(), slide = (1.0 - share) * reach;
                pair.put(b, (b ? at_b : at_a) + Vec2(around(slide), around(slide)),
                         (b ? angle_b : 0.0) + around(share * reach / model.blocks.radius[b]));
            }
            const Vec2 now = pair.distance();
            const double distance = separation(pair.part(0), pair.part(1), now.x(), now.y()).distance;
            if (kept.never) CHECK(distance >= 0.0);
            never += kept.never;
            touching += distance < 0.0;
            if (kept.idle.corner < 0) continue;
            ++quick;
            const PlacedPart by = pair.part(apart.of_a ? 0 : 1), other = pair.part(apart.of_a ? 1 : 0);
            const double by_edge =
                separation_by_edge(by, apart.edge, other, apart.of_a ? now.x() : -now.x(), apart.of_a ? now.y() : -now.y());
            const bool is_apart = by_edge >= -kept.idle.touch_depth;
            if (not_yet(pair.placed, kept.idle)) {
                CHECK(is_apart);
                ++passed_over;
            }
            if (i % 3 != 1) CHECK(still_apart(model, pair.placed, kept.idle) == is_apart);
        }
    }
    CHECK(never > 1000);
    CHECK(quick > 1000);
    CHECK(touching > 100);
    CHECK(passed_over > 100);
}

TEST_CASE("a shrinking contact loses shear force and gives up the energy; friction work is never negative") {
    Joint joint;
    joint.kn = 1e9, joint.ks = 1e9, joint.tan_friction = 1.0;
    ShearMemory c;
    mohr_coulomb(joint, {1e6, 1.0, 0.0, 0.0, -1e-4, 0.0}, c);
    CHECK(c.force == Approx(1e5));
    const ShearResult shrunk = mohr_coulomb(joint, {1e6, 0.5, 0.0, 0.0, 0.0, 0.0}, c);
    CHECK(c.force == Approx(0.5e5));
    CHECK(shrunk.released == Approx(0.5 * 1e5 * 1e-4 - 0.5 * 0.5e5 * 1e-4));
    const ShearResult slipped =
        mohr_coulomb(joint, {1e4, 0.5, 0.0, 0.0, 0.0, 0.0}, c);  // the normal force falls: it slips on its own
    CHECK(slipped.sliding);
    CHECK(c.force == Approx(1e4));
    CHECK(slipped.friction > 0.0);
}

TEST_CASE("strength drops to its residual value at the first slip and never comes back") {
    Joint joint;
    joint.kn = 1e10, joint.ks = 5e9, joint.tan_friction = std::tan(radians(30.0));
    joint.tan_friction_residual = std::tan(radians(25.0));
    joint.weakens = true;
    ShearMemory c;
    double peak = 0.0;
    for (int i = 0; i < 300; ++i) {
        mohr_coulomb(joint, {1e6, 1.0, 0.0, 0.0, -1e-6, 0.0}, c);
        peak = std::max(peak, c.force);
    }
    CHECK(peak == Approx(577350.3).epsilon(0.01));  // steps of 1e-6 m: at most 5 kPa short of it
    CHECK(c.force == Approx(466307.7).epsilon(1e-6));
    for (int i = 0; i < 300; ++i) mohr_coulomb(joint, {1e6, 1.0, 0.0, 0.0, 1e-6, 0.0}, c);
    CHECK(c.force == Approx(-466307.7).epsilon(1e-6));
}

TEST_CASE("dilation follows the net slip, up to its cut-off, and closes when slip comes back") {
    Joint joint;
    joint.kn = 1e10, joint.ks = 5e9, joint.tan_friction = 0.5, joint.tan_dilation = std::tan(radians(10.0));
    joint.dilation_cutoff_slip = 2e-3;
    ShearMemory c;
    const auto slide = [&](double by) {
        for (int i = 0; i < 1000; ++i) mohr_coulomb(joint, {1e6, 1.0, 0.0, 0.0, by / 1000, 0.0}, c);
    };
    slide(1e-3 + 0.5e6 / 5e9);
    // The shear force stands for the step to come, when the lift of this one presses: friction on
    // kn x lift = 880 N more, and a slip shorter by that over ks, 1.8e-7 m.
    CHECK(c.dilation == Approx(0.176327e-3).margin(0.18 * 2e-7));
    slide(5e-3);
    CHECK(c.dilation == Approx(2e-3 * std::tan(radians(10.0))).epsilon(1e-9));
    slide(-6e-3 - 2 * 0.5e6 / 5e9);
    CHECK(c.dilation < 0.18 * 2e-6);  // steps of 6.2e-6 m
}
