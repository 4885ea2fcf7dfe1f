// What the rigid solver promises whatever the scene: the same bits however it is computed, mirror images, momentum.
#include "model/hash.hpp"
#include "output/restart.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/scenes.hpp"
#include "support/whole_run.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

using namespace talus;
using namespace talus::test;

namespace {

// A slope that slides on its joints, with bonded blocks that break when they land, an L of two parts, and a stage before it.
const std::string slope = R"(
gravity: [0, -9.81]
materials: {rock: {density: 2500}}
joints:
  rough: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 12, restitution: 0.2}
  bond: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 30, cohesion: 2e4, tension: 1e4, residual: {cohesion: 0}}
contacts: {default: rough}
rock:
  outline: [[0, 0], [12, 0], [12, 1.5], [7, 1.5], [4, 8], [0, 8]]
  joint_sets:
    - {angle_deg: -35, spacing: 1.1, origin: [7, 2], joint: rough}
    - {angle_deg: 70, spacing: 1.3, origin: [7, 2], joint: bond}
  held: {left: true, bottom: true}
blocks:
  - {name: ell, outline: [[5, 8.2], [6.5, 8.2], [6.5, 8.7], [5.5, 8.7], [5.5, 9.7], [5, 9.7]], velocity: [-1, -2]}
stages: [{name: first, gravity: [1, -9.81], until: {time: 0.1}}]
run: {until: {time: 0.7}, solver: rigid}
)";

struct Trace {
    std::vector<std::uint64_t> hashes;
    int sliding = 0, broken = 0;
};

template <class Change>
Trace trace(const Scenario& scenario, Change change) {
    Trace found;
    WholeRun run(scenario);
    run.to_the_end([&](WholeRun& r) {
        change(r);
        for (const Contact& c : r.state().contacts.list) found.sliding += c.sliding;
        if (r.state().total_steps % 20 == 0) found.hashes.push_back(state_hash(r.model(), r.state()));
    });
    for (const std::uint8_t cell : run.state().contacts.broken) found.broken += cell != 0;
    found.hashes.push_back(state_hash(run.model(), run.state()));
    return found;
}

Trace trace(const Scenario& scenario) {
    return trace(scenario, [](WholeRun&) {});
}

const Trace& reference() {
    static const Trace found = trace(scenario_of(slope));
    return found;
}

/// Half of a portal seen from either side: a column, a beam that leans on it and slides down, a block thrown onto it.
Scenario portal(double side) {
    const auto flip = [&](Polygon p) {
        if (side > 0.0) return p;
        for (Vec2& v : p) v.x() = -v.x();
        std::reverse(p.begin(), p.end());
        return p;
    };
    auto thrown = scenes::block("thrown", flip({{-2, 6}, {-1.2, 6.1}, {-1.5, 6.9}}));
    thrown.velocity = {3.0 * side, 0.0};
    Scenario scene = scenes::with({scenes::held(scenes::block("ground", flip({{-9, -1}, {9, -1}, {9, 0}, {-9, 0}}))),
                                   scenes::block("column", flip({{0, 0}, {0.8, 0}, {0.7, 3}, {0.1, 3}})),
                                   scenes::block("beam", flip({{-0.5, 3}, {3, 3}, {3, 3.5}, {-0.5, 3.4}})), thrown});
    scene.joints[0].friction_angle = radians(25.0);
    scene.run.solver = "rigid";
    scene.run.until.time = 0.8;
    scene.run.time_step = 0.002;
    return scene;
}

}  // namespace

TEST_CASE("rigid: the slope of these tests slides and breaks") {
    CHECK(reference().sliding > 100);
    CHECK(reference().broken > 4);
}

TEST_CASE("rigid: one hash for every search, number of threads and skin") {
    for (const char* search : {"auto", "dess", "direct"})
        for (const int threads : {1, 2, 3})
            for (const double skin : {-1.0, 0.0, 0.3}) {
                Scenario scenario = scenario_of(slope);
                scenario.run.search = search;
                scenario.run.threads = threads;
                if (skin >= 0.0) scenario.run.skin = skin;
                CAPTURE(search, threads, skin);
                CHECK(trace(scenario).hashes == reference().hashes);
            }
}

TEST_CASE("rigid: scratch may be thrown away at any step") {
    const Trace found = trace(scenario_of(slope), [](WholeRun& r) {
        if (r.state().total_steps % 7 == 0) r.simulation().drop_scratch();
    });
    CHECK(found.hashes == reference().hashes);
}

TEST_CASE("rigid: a run saved and read back goes on as if it had not stopped") {
    const Folder folder;
    const std::string path = folder / "slope.restart.h5";
    const Trace found = trace(scenario_of(slope), [&](WholeRun& r) {
        if (r.state().total_steps % 23 != 0) return;
        write_restart(path, RestartInfo{}, r.state());
        State saved = read_restart(path, r.model());
        r.go_on_from(std::move(saved));
    });
    CHECK(found.hashes == reference().hashes);
}

TEST_CASE("rigid: a mirrored scene moves as the mirror image") {
    WholeRun run(portal(1.0)), image(portal(-1.0));
    run.to_the_end();
    image.to_the_end();
    for (BlockId b = 1; b < run.model().blocks.size(); ++b) {
        const Vec2 moved = run.state().motion.position[b] - run.state().start_position[b];
        const Vec2 other = image.state().motion.position[b] - image.state().start_position[b];
        CAPTURE(b, moved.x(), moved.y(), other.x(), other.y());
        if (b > 1) CHECK(moved.norm() > 0.05);
        CHECK((Vec2(-other.x(), other.y()) - moved).norm() < 1e-6);
        CHECK(std::abs(run.state().motion.angle[b] + image.state().motion.angle[b]) < 1e-6);
    }
}

TEST_CASE("rigid: free blocks that collide and rub keep their momentum, and nearly their angular momentum") {
    Scenario scene = scenes::with({scenes::block("a", scenes::rectangle(0, 0, 1, 1)),
                                   scenes::block("b", scenes::turned(scenes::rectangle(1.4, 0.2, 2.4, 0.9), 20.0)),
                                   scenes::block("c", scenes::rectangle(-1.5, 0.3, -0.3, 0.8))});
    scene.gravity = {};
    scene.blocks[0].velocity = {0.5, 0.1};
    scene.blocks[1].velocity = {-2.0, -0.3};
    scene.blocks[1].spin = 2.0;
    scene.blocks[2].velocity = {2.5, 0.0};
    scene.run.solver = "rigid";
    scene.run.until.time = 1.0;
    WholeRun run(scene);
    const auto momenta = [&] {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        const Motion& m = run.state().motion;
        for (BlockId b = 0; b < run.model().blocks.size(); ++b) {
            const Vec2 p = run.model().blocks.mass[b] * m.velocity[b];
            sum += Eigen::Vector3d(p.x(), p.y(), cross(m.position[b], p) + run.model().blocks.inertia[b] * m.spin[b]);
        }
        return sum;
    };
    const Eigen::Vector3d before = momenta();
    run.to_the_end();
    CHECK(run.simulation().energies().contact_damping > 0.0);
    const Eigen::Vector3d change = momenta() - before;
    CHECK(change.head<2>().norm() < 1e-12 * 2500.0 * 3.0);
    // Bodies are put on each other while they move past each other: an error of the order of the step, in impacts only.
    CHECK(std::abs(change.z()) < 0.01 * 2500.0 * 3.0);
}

// A column on rollers, and blocks that slide past each other along the only axis they have: no impulse between two of them
// can move them along the joint, or across it.
TEST_CASE("rigid: joints that cannot give way along or across stay in balance") {
    WholeRun rollers(scenario_of(R"(
gravity: [0, -9.81]
materials: {rock: {density: 2600}}
joints: {j: {normal_stiffness: 1e9, shear_stiffness: 1e9, friction_angle_deg: 30}}
rock:
  outline: [[0, 0], [6, 0], [6, 4], [0, 4]]
  joint_sets: [{angle_deg: 0, spacing: 1}, {angle_deg: 90, spacing: 2}]
  held: {left: roller, right: roller, bottom: true}
run: {until: {time: 0.5}, solver: rigid}
)"));
    rollers.to_the_end();
    for (BlockId b = 0; b < rollers.model().blocks.size(); ++b)
        CHECK((rollers.state().motion.position[b] - rollers.state().start_position[b]).norm() < 1e-8);

    // A shear box: driven from rest to 0.01 m/s in 0.1..0.5 s, it slips by 0.002 m against mu m g = tan 30 x 1300 x 9.81 N.
    WholeRun box(scenario_of(R"(
gravity: [0, -9.81]
materials: {rock: {density: 2600}}
joints: {j: {normal_stiffness: 1e9, shear_stiffness: 1e9, friction_angle_deg: 30}}
blocks:
  - {name: below, rectangle: {corner: [-5, -1], size: [11, 1]}, held: true}
  - {name: above, rectangle: {corner: [0, 0], size: [1, 0.5]}, held: [false, false, true], driven: {velocity_x: {time: [0, 0.1, 0.5], value: [0, 0, 0.01]}}}
  - {name: guided, rectangle: {corner: [3, 0], size: [1, 0.5]}, held: [true, false, true]}
  - {name: past it, rectangle: {corner: [4, 0], size: [1, 0.5]}, held: [true, false, true]}
run: {until: {time: 0.5}, solver: rigid}
)"));
    box.to_the_end();
    const State& state = box.state();
    CHECK(state.contacts.list[0].slip == Approx(0.002).epsilon(0.01));
    CHECK(state.ledger.friction == Approx(std::tan(std::numbers::pi / 6) * 1300 * 9.81 * 0.002).epsilon(0.01));
    for (const BlockId b : {2, 3}) CHECK((state.motion.position[b] - state.start_position[b]).norm() < 1e-8);
}

// Load of 20 times the weight, eccentric by a quarter of the base, inclined by nine tenths of friction: by Coulomb and by
// the middle half of the base it rests. Loads turn a block that stands as little as weight does.
TEST_CASE("rigid: a block under a large eccentric load stands as it would under its weight") {
    WholeRun run(scenario_of(R"(
gravity: [0, -9.81]
materials: {rock: {density: 2500}}
joints: {j: {normal_stiffness: 1e9, shear_stiffness: 1e9, friction_angle_deg: 30}}
blocks:
  - {name: base, rectangle: {corner: [-1, -1], size: [3, 1]}, held: true}
  - {name: block, rectangle: {corner: [0, 0], size: [1, 1]}}
loads: [{block: block, force: [2.54875e5, -4.905e5], point: [0.25, 0.2]}]
run: {until: {time: 1}, solver: rigid}
)"));
    run.to_the_end();
    CHECK((run.state().motion.position[1] - run.state().start_position[1]).norm() < 1e-8);
    CHECK(run.state().stage_step < 1.01 * std::sqrt(1.0 / 221.0) / 80.0);  // 22.5 g of load, 1 g of weight
}

// Housner: of its tilt a block that rocks keeps th1, where cos(a - th1) - cos a = r^2 (cos(a - th0) - cos a), a = atan(b/h),
// r = 1 - 1.5 sin^2 a.
TEST_CASE("rigid: a slender block that rocks loses at each impact what its shape says") {
    for (const double height : {2.0, 10.0, 30.0}) {
        CAPTURE(height);
        const double alpha = std::atan(0.5 / height), tilt = 0.5 * alpha;
        Scenario scene = scenes::with({scenes::block("floor", scenes::rectangle(-5, -1, 5, 0)),
                                       scenes::block("column", scenes::turned(scenes::rectangle(0, 0, 0.5, height),
                                                                              tilt * 180.0 / std::numbers::pi))});
        scene.blocks[0].held = {true, true, true};
        scene.joints[0].friction_angle = 1.2;
        scene.run.solver = "rigid";
        scene.run.until.time = 1.6 * std::sqrt(height);
        WholeRun run(scene);
        double least = 0.0;
        run.to_the_end([&](WholeRun& r) { least = std::min(least, r.state().motion.angle[1]); });
        const double r = 1.0 - 1.5 * std::pow(std::sin(alpha), 2);
        const double back = alpha - std::acos(std::cos(alpha) + r * r * (std::cos(alpha - tilt) - std::cos(alpha)));
        CHECK(-least == Approx(tilt + back).epsilon(1e-3));
    }
}

// Up with 1 m/s and g (sin 30 + cos 30 tan 20), back with g (sin 30 - cos 30 tan 20): of second order, wherever in a step it
// turns.
TEST_CASE("rigid: what slides up a slope turns back at once") {
    const double up = 9.81 * (0.5 + std::sqrt(0.75) * std::tan(std::numbers::pi / 9));
    const double down = 9.81 * (0.5 - std::sqrt(0.75) * std::tan(std::numbers::pi / 9)), turns = 1.0 / up;
    for (const double dt : {0.004, 0.0033, 0.0027, 0.001}) {
        CAPTURE(dt);
        Scenario scene = scenario_of(R"(
gravity: [4.905, -8.495709211]
materials: {rock: {density: 2600}}
joints: {j: {normal_stiffness: 1e9, shear_stiffness: 1e9, friction_angle_deg: 20}}
blocks:
  - {name: slope, rectangle: {corner: [-50, -1], size: [100, 1]}, held: true}
  - {name: block, rectangle: {corner: [0, 0], size: [1, 0.5]}, velocity: [-1, 0]}
run: {until: {time: 0.5}, solver: rigid}
)");
        scene.run.time_step = dt;
        WholeRun run(scene);
        run.to_the_end();
        const double slid = run.state().time - turns;
        const double x = 0.5 * down * slid * slid - 0.5 * turns;
        const double way = run.state().motion.position[1].x() - run.state().start_position[1].x();
        CHECK(std::abs(way - x) < 1.5 * dt * dt);
        CHECK(run.state().motion.velocity[1].x() == Approx(down * slid).margin(2.0 * dt * dt));
    }
}

// Nothing but an impact with restitution 1 acts: the kinetic energy stays, whichever of the faces at the tips they meet at.
TEST_CASE("rigid: two tips that meet off centre by less than corners are told apart bounce all the same") {
    for (const double offset : {-1e-6, 0.0, 1e-8, 1e-7, 1e-6, 1e-4}) {
        CAPTURE(offset);
        Scenario scene = scenes::with({scenes::block("a", {{0, 0}, {-0.5, 0.65}, {-1.3, 0.4}, {-1.3, -0.4}, {-0.5, -0.65}}),
                                       scenes::block("b", {{0.05, offset}, {0.95, -0.9}, {1.55, 0.4}})});
        scene.gravity = {};
        scene.blocks[0].velocity = {1.0, 0.0};
        scene.joints[0].friction_angle = 0.0;
        scene.joints[0].restitution = 1.0;
        scene.run.solver = "rigid";
        scene.run.until.time = 0.15;
        WholeRun run(scene);
        const double before = run.simulation().energies().kinetic;
        run.to_the_end();
        CHECK(run.state().motion.velocity[1].norm() > 0.1);
        CHECK(run.simulation().energies().kinetic == Approx(before).epsilon(1e-6));
    }
}
