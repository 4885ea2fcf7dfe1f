// The verdict: blocks that ring, rock, bounce or creep, masses that move as one, loads that change, runs that are resumed.
#include "output/h5_file.hpp"
#include "output/restart.hpp"
#include "scenario/reader.hpp"
#include "simulation/run.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/whole_run.hpp"

#include <sstream>

using namespace talus;
using namespace talus::test;

namespace {

const std::string head = R"(
title: test of the verdict
gravity: [0, -9.81]
materials:
  rock: {density: 2500}
)";

StabilityVerdict verdict_on(const std::string& text) {
    WholeRun run(scenario_of(text));
    run.to_the_end();
    return run.simulation().verdict();
}

// Ten stones on each other, cut without stress: under gravity switched on at once they ring for good, by a multiple of what
// one joint gives.
const std::string ringing = head + R"(
joints: {joint: {normal_stiffness: 1e8, shear_stiffness: 5e7, friction_angle_deg: 35}}
blocks:
  - {name: ground, rectangle: {corner: [-2, -1], size: [5, 1]}, held: true}
  - {name: stone, rectangle: {corner: [0, 0], size: [1, 0.5]}, repeat: {count: 10, step: [0, 0.5]}}
run: {until: {verdict: true, time: 10}}
)";

std::string rocking(const std::string& motion) {
    return head + R"(
joints: {joint: {friction_angle_deg: 60, normal_stiffness: 1e9, shear_stiffness: 1e9}}
blocks:
  - {name: ground, rectangle: {corner: [-5, -1], size: [10, 1]}, held: true}
  - {name: block, rectangle: {corner: [0, 0], size: [0.5, 1]}, )" +
           motion + R"(}
run: {until: {verdict: true, time: 30}, solver: rigid}
)";
}

std::string falling(double height, double restitution) {
    std::ostringstream text;
    text << head << "joints: {joint: {friction_angle_deg: 30, restitution: " << restitution
         << ", normal_stiffness: 1e9, shear_stiffness: 1e9}}\n"
         << "blocks:\n  - {name: ground, rectangle: {corner: [-5, -1], size: [10, 1]}, held: true}\n"
         << "  - {name: block, rectangle: {corner: [0, " << height << "], size: [1, 1]}}\n"
         << "run: {until: {verdict: true, time: 20}, solver: rigid}\n";
    return text.str();
}

// Eight bonded blocks in two rows on a plane of 30 degrees, one unit each, so that they slide as one.
std::string bonded_slab(const std::string& solver) {
    std::ostringstream text;
    text.precision(17);
    text << head << "  slab: {density: 2500}\n"
         << R"(joints:
  plane: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 20}
  bridge: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 30, cohesion: 1e7, tension: 1e7}
contacts: {default: plane, materials: [{a: slab, b: slab, joint: bridge}]}
blocks:
  - {name: plane, material: rock, rectangle: {corner: [-0.5, -0.86602540378443865], size: [60, 1], angle_deg: -30}, held: true}
)";
    const Vec2 down(std::cos(radians(30.0)), -0.5), up = perp(down);
    for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 4; ++column) {
            const Vec2 at = (3.0 + column) * down + row * up;
            text << "  - {material: slab, rectangle: {corner: [" << at.x() << ", " << at.y()
                 << "], size: [1, 1], angle_deg: -30}}\n";
        }
    text << "run: {until: {verdict: true, time: 10}, solver: " << solver << "}\n";
    return text.str();
}

// A mass of three blocks, a sector of 60 degrees of a disc of 5 m less its middle, lies askew in a round trough: 2 degrees
// to an edge.
std::string trough() {
    const auto at = [](double radius, double angle_deg) {
        std::ostringstream point;
        point.precision(17);
        point << "[" << radius * std::cos(radians(angle_deg)) << ", " << radius * std::sin(radians(angle_deg)) << "]";
        return point.str();
    };
    std::ostringstream text;
    text << head << "joints: {joint: {friction_angle_deg: 5, normal_stiffness: 1e9, shear_stiffness: 1e9}}\nblocks:\n";
    for (int angle = -180; angle < 0; angle += 2)
        text << "  - {held: true, outline: [" << at(5, angle) << ", " << at(6, angle) << ", " << at(6, angle + 2) << ", "
             << at(5, angle + 2) << "]}\n";
    for (const int first : {-80, -60, -40}) {
        text << "  - {name: mass" << -first << ", outline: [" << at(3, first);
        for (int angle = first; angle <= first + 20; angle += 2) text << ", " << at(5, angle);
        text << ", " << at(3, first + 20) << "]}\n";
    }
    text << "run: {until: {verdict: true, time: 10}, solver: rigid}\n";
    return text.str();
}

}  // namespace

TEST_CASE("undamped stones that ring for good stand") {
    const StabilityVerdict found = verdict_on(ringing);
    CAPTURE(found.reason);
    CHECK(found.verdict == Stability::stable);
    CHECK(found.mechanism == Mechanism::none);
    CHECK(found.moving_blocks == 0);
    CHECK(found.kinetic_energy > 0.0);
    CHECK(found.time < 10.0);
}

TEST_CASE("a block that rocks and comes back stands; one that is pushed over its corner topples") {
    // Energy to bring the centroid over the corner from rest: m g (R - h/2), I about the corner (4/3) m R^2, R^2 = (b^2 +
    // h^2)/4.
    const double r = 0.25 * std::sqrt(0.25 + 1.0) * 2.0, least = std::sqrt(2.0 * 9.81 * (r - 0.5) / (4.0 / 3.0 * r * r));
    for (const double share : {0.5, 0.9, 1.2}) {
        // Turning about the right corner: clockwise, with the velocity of the centroid that keeps the corner in its place.
        const double spin = -share * least;
        std::ostringstream motion;
        motion << "spin: " << spin << ", velocity: [" << -spin * 0.5 << ", " << -spin * 0.25 << "]";
        const StabilityVerdict found = verdict_on(rocking(motion.str()));
        CAPTURE(share, found.reason, name_of(found.mechanism));
        CHECK(found.verdict == (share < 1.0 ? Stability::stable : Stability::unstable));
        CHECK(found.mechanism == (share < 1.0 ? Mechanism::none : Mechanism::topple));
    }
}

TEST_CASE("a block that bounces and comes to rest stands; one that falls further than its size has fallen") {
    for (const double restitution : {0.0, 0.5}) {
        const StabilityVerdict found = verdict_on(falling(0.3, restitution));
        CAPTURE(restitution, found.reason);
        CHECK(found.verdict == Stability::stable);
    }
    const StabilityVerdict found = verdict_on(falling(20.0, 0.0));
    CAPTURE(found.reason);
    CHECK(found.verdict == Stability::unstable);
    CHECK(found.mechanism == Mechanism::fall);
    CHECK(found.detached_blocks == 1);
    CHECK(found.moving_area == Approx(1.0));
    CHECK(found.time < 2.0);
}

TEST_CASE("how much rock is a failure can be said") {
    // A ledge of 100 m2, and beside it a stone of 0.04 m2 that falls past it: a share of 0.0004.
    const auto scene = [](const std::string& share) {
        return head + R"(joints: {joint: {friction_angle_deg: 30, normal_stiffness: 1e9, shear_stiffness: 1e9}}
blocks:
  - {name: ground, rectangle: {corner: [-5, -1], size: [20, 1]}, held: true}
  - {name: ledge, rectangle: {corner: [0, 0], size: [10, 10]}}
  - {name: stone, rectangle: {corner: [16, 5], size: [0.2, 0.2]}}
run: {until: {verdict: true, time: 20}, solver: rigid)" +
               share + "}\n";
    };
    for (const char* share : {"", ", smallest_failure: 0.0005"}) {
        const StabilityVerdict found = verdict_on(scene(share));
        CAPTURE(share, found.reason);
        CHECK(found.verdict == Stability::stable);
        CHECK(found.mechanism == Mechanism::none);
        CHECK(found.moving_blocks == 1);
        CHECK(found.moving_share == Approx(0.04 / 100.04));
        CHECK(found.block_mechanism.back() == Mechanism::fall);
    }
    for (const char* share : {", smallest_failure: 0", ", smallest_failure: 0.0003"}) {
        const StabilityVerdict found = verdict_on(scene(share));
        CAPTURE(share, found.reason);
        CHECK(found.verdict == Stability::unstable);
        CHECK(found.mechanism == Mechanism::fall);
    }
}

TEST_CASE("a block that slides out from between its neighbours and then drops has fallen; one that has slid far has slid") {
    // In a slot of 75 degrees between two walls, drawn along its axis. The end of the slot is `ahead` of the block.
    const auto in_a_slot = [](double ahead) {
        std::ostringstream text;
        text.precision(17);
        text << "title: slot\ngravity: [" << 9.81 * std::sin(radians(75.0)) << ", " << -9.81 * std::cos(radians(75.0))
             << "]\n"
             << "materials: {rock: {density: 2500}}\n"
             << "joints: {joint: {friction_angle_deg: 20, normal_stiffness: 1e9, shear_stiffness: 1e9}}\nblocks:\n"
             << "  - {name: below, rectangle: {corner: [-30, -1], size: [30, 1]}, held: true}\n"
             << "  - {name: above, rectangle: {corner: [-30, 1], size: [30, 1]}, held: true}\n"
             << "  - {name: block, rectangle: {corner: [" << -1.2 - ahead << ", 0], size: [1.2, 1]}}\n"
             << "run: {until: {time: 4}, solver: rigid}\n";
        return text.str();
    };
    const StabilityVerdict drops = verdict_on(in_a_slot(0.0)), slides = verdict_on(in_a_slot(5.0));
    CAPTURE(drops.reason, slides.reason);
    CHECK(drops.verdict == Stability::unstable);
    CHECK(drops.mechanism == Mechanism::fall);
    CHECK(slides.verdict == Stability::unstable);
    CHECK(slides.mechanism == Mechanism::slide);
}

TEST_CASE("blocks that go together go the way of the mass") {
    for (const char* solver : {"explicit", "rigid"}) {
        const StabilityVerdict found = verdict_on(bonded_slab(solver));
        CAPTURE(solver, found.reason);
        CHECK(found.verdict == Stability::unstable);
        CHECK(found.mechanism == Mechanism::slide);
        CHECK(found.moving_blocks == 8);
        for (std::size_t b = 1; b < 9; ++b) CHECK(found.block_mechanism[b] == Mechanism::slide);
    }
}

TEST_CASE("a mass that turns in a round trough rotates, all of its blocks together") {
    const StabilityVerdict found = verdict_on(trough());
    CAPTURE(found.reason);
    CHECK(found.verdict == Stability::unstable);
    CHECK(found.mechanism == Mechanism::rotation);
    CHECK(found.moving_blocks == 3);
}

TEST_CASE("nothing is said for good while the loads still change") {
    const std::string scene =
        head + R"(joints: {joint: {friction_angle_deg: 30, normal_stiffness: 1e9, shear_stiffness: 1e9}}
blocks:
  - {name: ground, rectangle: {corner: [-5, -1], size: [100, 1]}, held: true}
  - {name: block, rectangle: {corner: [0, 0], size: [1, 0.5]}}
)";
    // Sideways more and more, beyond friction after 2.9 s, and constant from 4 s on.
    const std::string shaken = "body_acceleration: {time: [0, 4], x: [0, 8], y: [0, 0]}\n";
    const StabilityVerdict before = verdict_on(scene + shaken + "run: {until: {verdict: true, time: 2.5}, solver: rigid}\n");
    CAPTURE(before.reason);
    CHECK(before.verdict == Stability::undecided);
    CHECK(before.time == Approx(2.5));
    const StabilityVerdict after = verdict_on(scene + shaken + "run: {until: {verdict: true, time: 20}, solver: rigid}\n");
    CAPTURE(after.reason);
    CHECK(after.verdict == Stability::unstable);
    CHECK(after.mechanism == Mechanism::slide);
    CHECK(after.time >= 4.0);
    const StabilityVerdict pulse =
        verdict_on(scene + "body_acceleration: {time: [0, 1, 1.2], x: [0, 8, 0], y: [0, 0, 0]}\n" +
                   "run: {until: {verdict: true, time: 20}, solver: rigid}\n");
    CAPTURE(pulse.reason, pulse.max_displacement);
    CHECK(pulse.max_displacement > 1e-3);  // it slid, and stopped
    CHECK(pulse.verdict == Stability::stable);
}

TEST_CASE("a run that is resumed comes to the same verdict in the same step") {
    const Scenario scenario = scenario_of(bonded_slab("explicit"));
    WholeRun whole(scenario);
    whole.to_the_end();
    const StabilityVerdict expected = whole.simulation().verdict();
    const Folder folder;
    const std::string path = folder / "run.restart.h5";
    WholeRun resumed(scenario);
    resumed.to_the_end([&](WholeRun& r) {
        if (r.state().total_steps % 333 != 0) return;
        write_restart(path, {}, r.state());
        r.go_on_from(read_restart(path, r.model()));
    });
    const StabilityVerdict found = resumed.simulation().verdict();
    CHECK(whole.state().total_steps > 2 * 333);
    CHECK(resumed.state().total_steps == whole.state().total_steps);
    CHECK(found.reason == expected.reason);
    CHECK(found.block_mechanism == expected.block_mechanism);
    CHECK(found.displacement_trend == expected.displacement_trend);
}

TEST_CASE("results keep the verdict with its reason and the mechanism of each block") {
    const Folder folder;
    const Scenario scenario = scenario_of(falling(20.0, 0.0));
    Simulation simulation(scenario, build(scenario));
    simulation.begin_stage();
    Recorder recorder(folder / "run.h5", simulation, std::vector<std::string>{});
    RunOptions options;
    options.recorder = &recorder;
    options.entry = Entry::begun;
    CHECK(run(simulation, options) == Outcome::complete);
    recorder.finish(simulation, "complete", 1.0);
    const h5::File file = h5::File::open(folder / "run.h5");
    CHECK(file.text("/talus/verdict", "verdict") == "unstable");
    CHECK(file.text("/talus/verdict", "mechanism") == "fall");
    CHECK(file.text("/talus/verdict", "reason").find("`block`") != std::string::npos);
    CHECK(file.numbers("/talus/verdict", "time").at(0) == simulation.verdict().time);
    CHECK(file.read<std::uint8_t>("/talus/verdict/block_mechanism") == std::vector<std::uint8_t>{0, 4});
}

TEST_CASE("loads that a table only repeats do not change any more") {
    const std::string scene = R"(
materials: {rock: {density: 2500}}
joints: {joint: {normal_stiffness: 1e10, shear_stiffness: 5e9, friction_angle_deg: 40}}
blocks:
  - {name: ground, rectangle: {corner: [-2, -1], size: [4, 1]}, held: true}
  - {name: block, rectangle: {corner: [-0.5, 0], size: [1, 1]}}
run: {until: {time: 3}, damping: {local: 0.5}}
)";
    const auto verdict = [&](const std::string& gravity) { return verdict_on("gravity: " + gravity + scene).verdict; };
    CHECK(verdict("{time: [0, 0.5, 100], y: [-9.0, -9.81, -9.81], x: [0, 0, 0]}") == Stability::stable);
    CHECK(verdict("{time: [0, 0.5, 50, 100], y: [-9.0, -9.81, -9.81, -9.81], x: [0, 0, 0, 0]}") == Stability::stable);
    CHECK(verdict("{time: [0, 0.5, 100], y: [-9.81, -9.81, -9.0], x: [0, 0, 0]}") == Stability::undecided);
}
