// What mechanics keeps: momentum, mirror images, shifted coordinates; and that nothing passes through a wall.
#include "core/random.hpp"
#include "model/hash.hpp"
#include "output/restart.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/scenes.hpp"
#include "support/whole_run.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

using namespace talus;
using namespace talus::test;

namespace {

struct Momentum {
    Vec2 linear = Vec2::Zero();
    double angular = 0.0;  // about the origin
};

Momentum momentum(const Model& model, const State& state) {
    Momentum sum;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        const Vec2 p = model.blocks.mass[b] * state.motion.velocity[b];
        sum.linear += p;
        sum.angular += cross(state.motion.position[b], p) + model.blocks.inertia[b] * state.motion.spin[b];
    }
    return sum;
}

/// A convex polygon of n corners on a circle, unevenly spread.
Polygon pebble(Random& random, const Vec2& centre, double radius, int n) {
    Polygon corners;
    for (int i = 0; i < n; ++i) {
        const double angle = 2.0 * std::numbers::pi * (i + 0.6 * random.uniform()) / n;
        corners.push_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
    }
    return corners;
}

/// 16 pebbles that all fly towards the middle, and an L of two convex parts that comes in from the side.
Scenario cloud() {
    Random random(3);
    std::vector<BlockSpec> blocks;
    for (int i = 0; i < 16; ++i) {
        const Vec2 centre(1.5 * (i % 4) - 2.25, 1.5 * static_cast<double>(i / 4) - 2.25);
        blocks.push_back(scenes::block("", pebble(random, centre, 0.7, 3 + i % 5)));
        blocks.back().velocity = -2.0 * centre + Vec2(random.normal(), random.normal());
        blocks.back().spin = 3.0 * random.normal();
    }
    blocks.push_back(scenes::block("", {{4, -1}, {7, -1}, {7, 0}, {5, 0}, {5, 2}, {4, 2}}));
    blocks.back().velocity = {-6.0, 0.5};
    Scenario scene = scenes::with(blocks);
    scene.gravity = {};
    scene.joints[0].normal_stiffness = 1e8, scene.joints[0].shear_stiffness = 5e7;
    scene.joints[0].dilation_angle = radians(3.0);
    scene.run.damping.contact = 1e-5;
    scene.run.until.time = 1.0;
    return scene;
}

/// The same scene seen from behind: x becomes -x.
Scenario mirrored(Scenario scene) {
    const auto flip = [](Polygon& outline) {
        for (Vec2& p : outline) p.x() = -p.x();
        std::reverse(outline.begin(), outline.end());
    };
    for (double& g : scene.gravity.x.value) g = -g;
    for (BlockSpec& block : scene.blocks) {
        flip(block.outline);
        block.velocity.x() = -block.velocity.x();
        block.spin = -block.spin;
    }
    return scene;
}

/// Blocks on a stepped slope, some sliding, one toppling, one thrown onto them; not symmetric in any way.
Scenario steps() {
    auto slider = scenes::block("slider", {{2, 3}, {3, 3}, {3.2, 4}, {2.1, 4}});
    auto tower = scenes::block("tower", {{3.5, 3}, {4, 3}, {4, 5}, {3.5, 5}});
    auto thrown = scenes::block("thrown", {{6, 6}, {6.8, 6.1}, {6.5, 6.9}});
    thrown.velocity = {-5.0, 1.0};
    thrown.spin = 1.0;
    Scenario scene = scenes::with(
        {scenes::held(scenes::block("ground", {{0, 0}, {9, 0}, {9, 1}, {5, 1}, {5, 3}, {0, 3}})), slider, tower, thrown});
    scene.gravity.x = TimeTable::constant(3.0);
    scene.joints[0].normal_stiffness = 1e8, scene.joints[0].shear_stiffness = 5e7;
    scene.joints[0].friction_angle = radians(12.0);
    scene.run.until.time = 0.6;
    return scene;
}

/// Points are written <x y> in the text; they come out as [x, y], moved.
Scenario shifted(const std::string& text, const Vec2& by) {
    std::ostringstream moved;
    moved.precision(17);
    for (std::size_t at = 0;;) {
        const std::size_t begin = text.find('<', at), end = text.find('>', at);
        moved << text.substr(at, begin - at);
        if (begin == std::string::npos) return scenario_of(moved.str());
        double x = 0.0, y = 0.0;
        std::istringstream(text.substr(begin + 1, end - begin - 1)) >> x >> y;
        moved << '[' << x + by.x() << ", " << y + by.y() << ']';
        at = end + 1;
    }
}

const std::string incline = R"(
gravity: [0, -9.8125]
materials: {rock: {density: 2500}}
joints: {base: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 20}}
blocks:
  - {name: plane, held: true, outline: [<3.25 1.5>, <11.25 1.5>, <11.25 5.5>]}
  - {name: block, outline: [<7.25 3.5>, <9.25 4.5>, <8.75 5.5>, <6.75 4.5>]}
run: {until: {time: 0.5}}
)";

const std::string jointed_slope = R"(
gravity: [0, -9.8125]
materials: {rock: {density: 2500}}
joints: {bedding: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 20, cohesion: 1e4, tension: 1e3}}
rock:
  outline: [<3.25 1.5>, <23.25 1.5>, <23.25 4.5>, <15.25 4.5>, <9.25 13.5>, <3.25 13.5>]
  joint_sets:
    - {angle_deg: -35, spacing: 1.5, origin: <5.125 2.25>}
    - {angle_deg: 60, spacing: 2, origin: <5.125 2.25>}
  held: {left: true, right: true, bottom: true}
loads: [{block: {at: <9.125 12.5>}, force: [1e4, 0], point: <9.125 12.5>}]
run: {until: {time: 0.3}}
)";

const Vec2 far(4.5e5, 6.5e6);  // m, a place in a map

/// A cube of 0.1 m thrown at a wall of 0.1 m.
Scenario shot(double speed, double gap) {
    auto cube = scenes::block("cube", scenes::rectangle(-0.1 - gap, 0.0, -gap, 0.1));
    cube.velocity = {speed, 0.0};
    Scenario scene = scenes::with({scenes::held(scenes::block("wall", scenes::rectangle(0.0, -1.0, 0.1, 1.0))), cube});
    scene.gravity = {};
    // Stiff enough that 3 cm of overlap stop the cube; a step near the stable limit is then 6 cm long.
    scene.joints[0].normal_stiffness = 250.0 * speed * speed / (0.03 * 0.03);
    scene.joints[0].shear_stiffness = 0.01 * scene.joints[0].normal_stiffness;  // or turning would govern the step
    scene.run.time_step = 1.9 * 0.03 / speed;
    scene.run.until.time = 4.0 * (gap + 0.1) / speed;
    return scene;
}

}  // namespace

TEST_CASE("free blocks that collide, rub and are damped keep their momentum and angular momentum") {
    WholeRun run(cloud());
    const Momentum before = momentum(run.model(), run.state());
    double mass_speed = 0.0, angular = 0.0;
    for (BlockId b = 0; b < run.model().blocks.size(); ++b) {
        const double p = run.model().blocks.mass[b] * run.state().motion.velocity[b].norm();
        mass_speed += p;
        angular += p * run.state().motion.position[b].norm();
    }
    std::size_t contacts = 0;
    run.to_the_end([&](WholeRun& r) {
        std::size_t touching = 0;
        for (const Contact& c : r.state().contacts.list) touching += c.touching;
        contacts = std::max(contacts, touching);
    });
    const Momentum after = momentum(run.model(), run.state());
    CAPTURE(before.linear.x(), before.linear.y(), before.angular, contacts);
    CHECK(contacts > 8);
    CHECK(run.simulation().energies().friction > 0.0);
    CHECK(run.simulation().energies().contact_damping > 0.0);
    CHECK((after.linear - before.linear).norm() < 1e-12 * mass_speed);
    CHECK(std::abs(after.angular - before.angular) < 1e-9 * angular);
}

TEST_CASE("a mirrored scene moves as the mirror image") {
    for (const bool face_path : {true, false}) {
        Scenario scene = steps();
        scene.run.face_path = face_path;
        WholeRun run(scene), image(mirrored(scene));
        run.to_the_end();
        image.to_the_end();
        const Motion &m = run.state().motion, &i = image.state().motion;
        CHECK(run.simulation().energies().friction > 0.0);
        REQUIRE(run.state().total_steps == image.state().total_steps);
        for (BlockId b = 0; b < run.model().blocks.size(); ++b) {
            const Vec2 moved = m.position[b] - run.state().start_position[b];
            const Vec2 image_moved = i.position[b] - image.state().start_position[b];
            CAPTURE(face_path, b, moved.x(), moved.y(), image_moved.x(), image_moved.y(), m.angle[b], i.angle[b]);
            if (b > 0) CHECK(moved.norm() > 0.05);
            CHECK((Vec2(-image_moved.x(), image_moved.y()) - moved).norm() < 1e-9);
            CHECK(std::abs(m.angle[b] + i.angle[b]) < 1e-9);
        }
    }
}

TEST_CASE("far coordinates give the same displacements to 1e-9") {
    for (const auto& [text, length] : {std::pair(incline, 0.5), std::pair(jointed_slope, 0.008)}) {
        // A slope multiplies rounding by ten every few hundredths of a second: only its first moments can be compared.
        Scenario near_scene = shifted(text, Vec2::Zero()), far_scene = shifted(text, far);
        near_scene.run.until.time = far_scene.run.until.time = length;
        WholeRun here(near_scene), there(far_scene);
        CHECK(here.model().origin == Vec2(0.0, 0.0));
        CHECK(there.model().origin == far + Vec2(3.0, 1.0));
        here.to_the_end();
        there.to_the_end();
        REQUIRE(here.model().blocks.size() == there.model().blocks.size());
        double farthest = 0.0, apart = 0.0;
        for (BlockId b = 0; b < here.model().blocks.size(); ++b) {
            const Vec2 moved = here.state().motion.position[b] - here.state().start_position[b];
            const Vec2 also = there.state().motion.position[b] - there.state().start_position[b];
            farthest = std::max(farthest, moved.norm());
            apart = std::max(apart, (also - moved).norm());
        }
        CAPTURE(here.model().blocks.size(), farthest, apart);
        CHECK(farthest > 1e-4);
        CHECK(apart < 1e-9 * farthest);
    }
}

TEST_CASE("far coordinates lose no digit: with the origin moved along, a slope moves in the same bits") {
    const std::string text = "origin: <3 1>\n" + jointed_slope;
    WholeRun here(shifted(text, Vec2::Zero())), there(shifted(text, far));
    here.to_the_end();
    there.to_the_end();
    CHECK(here.simulation().energies().kinetic > 1e3);
    CHECK(state_hash(here.model(), here.state()) == state_hash(there.model(), there.state()));
}

TEST_CASE("nothing passes through a thin wall, however fast it comes") {
    for (const double speed : {10.0, 30.0, 100.0, 300.0, 1000.0})
        for (int phase = 0; phase < 8; ++phase) {  // where in a step contact begins
            WholeRun run(shot(speed, 0.3 + 0.007 * phase));
            int halvings = 0;
            double deepest = 0.0;
            run.to_the_end([&](WholeRun& r) {
                halvings = std::max(halvings, r.state().step_halvings);
                for (const Contact& c : r.state().contacts.list) deepest = std::max(deepest, c.touching ? c.overlap : 0.0);
            });
            CAPTURE(speed, phase, halvings, deepest, run.state().motion.velocity[1].x());
            CHECK(halvings > 0);
            CHECK(deepest < 0.05);  // half the wall: beyond it, forces point to the other side
            CHECK(run.state().motion.position[1].x() < -0.05);
            CHECK(run.state().motion.velocity[1].x() == Approx(-speed).epsilon(0.3));
        }
}

TEST_CASE("a run with halved steps goes on bit for bit from a restart") {
    const Folder folder;
    const std::string path = folder / "shot.restart.h5";
    const Scenario scene = shot(300.0, 0.3);
    WholeRun straight(scene), saved(scene);
    straight.to_the_end();
    int saves = 0;
    saved.to_the_end([&](WholeRun& r) {
        if (r.state().step_halvings == 0) return;
        write_restart(path, RestartInfo{}, r.state());
        r.go_on_from(read_restart(path, r.model()));
        ++saves;
    });
    CHECK(saves > 5);
    CHECK(state_hash(straight.model(), straight.state()) == state_hash(saved.model(), saved.state()));
    CHECK(straight.state().total_steps == saved.state().total_steps);
}
