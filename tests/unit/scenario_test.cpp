// Good input: every section of a scenario file, expansion of blocks, overrides, cases, origin.
#include "scenario/reader.hpp"
#include "support/catch.hpp"
#include "unit/scenario_text.hpp"

#include <cmath>
#include <numbers>

using namespace talus;
using test::full_scenario;
using test::small_scenario;

namespace {

constexpr double degree = std::numbers::pi / 180.0;

Scenario read(const std::string& text, const std::vector<std::string>& overrides = {}) {
    return read_scenario_text(text, "test.yaml", "", overrides);
}

double area(const Polygon& p) {
    double twice = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) twice += cross(p[i], p[(i + 1) % p.size()]);
    return twice / 2.0;
}

const BlockSpec& block(const Scenario& scenario, const std::string& name) {
    for (const BlockSpec& b : scenario.blocks)
        if (b.name == name) return b;
    FAIL("no block " + name);
    return scenario.blocks.front();
}

}  // namespace

TEST_CASE("materials, joints and contacts are read in SI units with angles in radians") {
    const Scenario s = read(full_scenario);
    CHECK(s.gravity(7.0) == Vec2(0, -9.81));
    CHECK(s.body_acceleration(0.25) == Vec2(1.25, 0));
    REQUIRE(s.materials.size() == 2);
    CHECK(s.materials[1].density == 2400.0);
    const JointSpec& bedding = s.joints.at(0);
    CHECK(bedding.normal_stiffness == 1e10);
    CHECK(bedding.friction_angle == Approx(30 * degree));
    CHECK(bedding.dilation_angle == Approx(5 * degree));
    CHECK(bedding.dilation_cutoff_slip == 0.01);
    CHECK(bedding.cells == 4);
    REQUIRE(bedding.residual);
    CHECK(bedding.residual->friction_angle == Approx(30 * degree));  // not given: the peak
    CHECK(bedding.residual->cohesion == 0.0);
    CHECK_FALSE(s.joints.at(1).residual);
    CHECK(s.joints.at(1).cells == 2);
    CHECK(s.joints.at(2).cohesion == 1e5);  // by an alias
    CHECK(s.contacts.default_joint == "floor");
    CHECK(s.contacts.materials.at(0).joint == "bedding");
    CHECK(s.contacts.blocks.at(0).a == "wall");
}

TEST_CASE("rock is read with its joint sets, holes, regions and supports") {
    const RockSpec rock = *read(full_scenario).rock;
    CHECK(rock.outline.size() == 6);
    CHECK(rock.joint_sets.at(0).name == "set1");
    CHECK(rock.joint_sets[0].angle.mean == Approx(-35 * degree));
    CHECK(rock.joint_sets[0].angle.deviation == 0.0);
    const JointSetSpec& cross_set = rock.joint_sets.at(1);
    CHECK(cross_set.angle.deviation == Approx(5 * degree));
    CHECK(cross_set.spacing.distribution == Distribution::lognormal);
    CHECK(cross_set.persistence == 0.8);
    CHECK(cross_set.trace_length.mean == 15.0);  // 5 times the mean spacing
    CHECK(cross_set.seed == 7);
    CHECK(cross_set.joint.empty());
    CHECK(cross_set.inside.size() == 4);
    CHECK(rock.cracks.at(0).points.at(1) == Vec2(5, 5));
    CHECK(area(rock.holes.at(0)) == Approx(0.5 * 8 * 4 * std::sin(2 * std::numbers::pi / 8)));
    CHECK(rock.regions.at(0).name == "tunnel");
    CHECK(rock.regions[0].material == "shale");
    CHECK(area(rock.regions.at(1).outline) == Approx(100.0));  // given clockwise
    CHECK(rock.held.left == SideSupport::held);
    CHECK(rock.held.right == SideSupport::roller);
    CHECK(rock.held.top == SideSupport::none);
    CHECK(rock.held.below == 2.0);
    CHECK_FALSE(rock.held.above);
    CHECK(rock.held.inside.size() == 1);
    CHECK(rock.slivers.given);
    CHECK(rock.slivers.area == 1e-4);
}

TEST_CASE("repeated blocks get the names of their row and column, and every second row is staggered") {
    const Scenario s = read(full_scenario);
    CHECK(s.blocks.size() == 6 + 4 + 1 + 1);
    CHECK(block(s, "wall[0][2]").outline.at(0) == Vec2(104, 0));
    CHECK(block(s, "wall[1][0]").outline.at(0) == Vec2(100.5, 1));
    CHECK(block(s, "wall[1][2]").outline.at(2) == Vec2(106.5, 2));
    CHECK(area(block(s, "wall[1][2]").outline) == Approx(2.0));
}

TEST_CASE("voussoirs of an arch share their corners and cover the ring") {
    const Scenario s = read(full_scenario);
    double total = 0.0;
    for (int i = 0; i < 4; ++i) {
        const Polygon& voussoir = block(s, "arch[" + std::to_string(i) + "]").outline;
        CHECK(area(voussoir) > 0.0);
        total += area(voussoir);
        if (i == 0) continue;
        const Polygon& before = block(s, "arch[" + std::to_string(i - 1) + "]").outline;
        CHECK(before[2] == voussoir[1]);
        CHECK(before[3] == voussoir[0]);
    }
    // Four trapezia between chords: (R^2 - r^2)/2 sin 45 each
    CHECK(total == Approx(4 * 0.5 * (5.5 * 5.5 - 4.5 * 4.5) * std::sin(45 * degree)));
    CHECK(block(s, "arch[0]").outline[1].x() == Approx(205.5));
    CHECK(block(s, "arch[0]").held.x);
    CHECK_FALSE(block(s, "arch[0]").held.rotation);
}

TEST_CASE("single blocks are turned counter-clockwise and keep their motion") {
    const Scenario s = read(full_scenario);
    const BlockSpec& triangle = block(s, "block4");
    CHECK(area(triangle.outline) == Approx(0.5));
    CHECK(triangle.outline[0] == Vec2(50, 50));
    CHECK(triangle.velocity == Vec2(1, -2));
    CHECK(triangle.spin == 0.5);
    const BlockSpec& plate = block(s, "plate");
    CHECK((*plate.driven.velocity_x)(0.5) == 0.25);
    CHECK((*plate.driven.velocity_y)(0.5) == 0.0);
    CHECK_FALSE(plate.held.x);
    CHECK(plate.held.rotation);
}

TEST_CASE("loads, initial stress and selectors are read") {
    const Scenario s = read(full_scenario);
    CHECK(s.loads.at(0).block.block == "wall[0][1]");
    CHECK(s.loads[0].force(1.0) == Vec2(0, -1000));
    CHECK(*s.loads[0].point == Vec2(103, 1));
    CHECK(*s.loads.at(1).block.at == Vec2(5, 5));
    CHECK(s.loads[1].force(0.5) == Vec2(5, 0));
    CHECK(s.loads[1].moment(9.0) == 3.0);
    CHECK(s.initial_stress->k0 == 0.5);
    CHECK(s.initial_stress->surface == 40.0);
    CHECK(s.initial_stress->left);
    CHECK_FALSE(s.initial_stress->top);
}

TEST_CASE("a settling stage is damped, ends in equilibrium and resets") {
    const StageSpec settle = read(full_scenario).stages.at(0);
    CHECK(settle.name == "stage1");
    CHECK(settle.reset);
    CHECK(settle.damping.local == 0.8);
    CHECK(settle.until.equilibrium == 1e-6);
    CHECK_FALSE(settle.until.time);

    const Scenario own =
        read(small_scenario + "stages: [{settle: true, reset: false, damping: {local: 0.5}, until: {time: 3}}]\n");
    CHECK_FALSE(own.stages.at(0).reset);
    CHECK(own.stages[0].damping.local == 0.5);
    CHECK(own.stages[0].until.time == 3.0);
    CHECK(own.stages[0].until.equilibrium == 1e-6);
}

TEST_CASE("with stages a run may end with the last of them, and takes nothing from `run` that belongs to a stage") {
    const std::string scene =
        small_scenario.substr(0, small_scenario.find("run:")) + "stages: [{name: fall, until: {time: 3}}]\n";
    for (const std::string run : {"run: {}\n", "run: {threads: 2}\n", ""}) {
        const Scenario s = read(scene + run);
        CHECK_FALSE(s.run.until.time);
        CHECK(s.stages.size() == 1);
    }
    CHECK_THROWS_WITH(read(scene + "run: {time_step: 1e-3}\n"), Catch::Contains("5 run.time_step: goes with run.until"));
    CHECK_THROWS_WITH(read(scene + "run: {damping: {local: 0.1}}\n"), Catch::Contains("5 run.damping: goes with run.until"));
}

TEST_CASE("a stage that changes a joint keeps its other values, also those of earlier stages") {
    const Scenario s = read(full_scenario);
    const StageSpec& excavate = s.stages.at(1);
    CHECK(excavate.remove.size() == 4);
    CHECK(excavate.remove[0].block == "tunnel");
    CHECK(excavate.remove[1].region == "cap");
    CHECK(*excavate.remove[2].at == Vec2(30, 20));
    CHECK(excavate.remove[3].inside.size() == 3);
    CHECK(excavate.loads_given);
    CHECK(excavate.loads.empty());
    CHECK((*excavate.gravity)(0.5) == Vec2(0.5, -9.81));
    CHECK(excavate.time_step == 1e-5);
    const JointSpec& first = excavate.joints.at(0);
    CHECK(first.friction_angle == Approx(20 * degree));
    CHECK(first.residual->friction_angle == Approx(15 * degree));
    CHECK(first.normal_stiffness == 1e10);
    const JointSpec& second = s.stages.at(2).joints.at(0);
    CHECK(second.friction_angle == Approx(20 * degree));
    CHECK(second.cohesion == 5e4);
    CHECK(second.tension == 2e4);
    CHECK_FALSE(s.stages[2].loads_given);
}

TEST_CASE("a stage that names no solver has that of the run") {
    CHECK(read(full_scenario).stages[1].solver == "explicit");
    CHECK(read("stages: [{name: first, settle: true}]\n" + small_scenario).stages[0].solver == "auto");
}

TEST_CASE("run and record are read, and absent values stay automatic") {
    const Scenario s = read(full_scenario);
    CHECK(s.run.until.time == 2.0);
    CHECK(s.run.solver == "explicit");
    CHECK(s.run.time_step == 2e-5);
    CHECK(s.run.skin == 0.01);
    CHECK_FALSE(s.run.face_path);
    CHECK(s.run.threads == 2);
    CHECK(s.record.frame_every == 0.05);
    CHECK_FALSE(s.record.frame_count);
    CHECK_FALSE(s.record.contacts);

    const Scenario small = read(small_scenario);
    CHECK_FALSE(small.run.time_step);
    CHECK_FALSE(small.run.skin);
    CHECK(small.run.step_fraction == 0.8);
    CHECK(small.run.damping.local == 0.0);
    CHECK(small.record.frame_count == 50);
    CHECK(small.record.contacts);
    CHECK(small.blocks.at(0).material == "rock");  // the only one
}

TEST_CASE("histories without a quantity record what belongs to their place") {
    const RecordSpec record = read(full_scenario).record;
    const auto& point = record.history.at(0);
    CHECK(point.name == "history1");
    CHECK(point.every == 0.001);
    REQUIRE(point.probes.size() == 4);
    CHECK(point.probes[0].quantity == "displacement");
    CHECK(point.probes[0].component == "x");
    CHECK(point.probes[3].quantity == "velocity");
    CHECK(point.probes[3].component == "y");
    CHECK(*point.probes[0].point == Vec2(30, 30));
    REQUIRE(record.history.at(1).probes.size() == 2);
    CHECK(*record.history[1].probes[1].joint == Vec2(10, 20));
    REQUIRE(record.history.at(2).probes.size() == 1);
    CHECK(record.history[2].probes[0].component == "y");
    CHECK(record.history[2].probes[0].block == "plate");
}

TEST_CASE("an expectation says what to observe, how to measure it and what must come out") {
    const std::vector<ExpectSpec> e = read(full_scenario).expect;
    REQUIRE(e.size() == 8);
    CHECK(e[0].measure == "value");
    CHECK(e[0].probe.component == "magnitude");
    CHECK_FALSE(e[0].at);
    CHECK(e[0].tolerance == 0.01);
    CHECK(e[1].probe.quantity == "velocity");
    CHECK(e[1].measure == "rate");
    CHECK(e[1].probe.component == "along");
    CHECK(e[1].probe.direction == Approx(-30 * degree));
    CHECK(e[1].between->second == 1.0);
    CHECK(e[2].measure == "frequency");
    CHECK(e[2].probe.quantity == "rotation");
    CHECK(e[2].above == 2.0);
    CHECK(e[3].measure == "loop_area");
    CHECK(e[3].probe.quantity == "shear_stress");
    CHECK(e[3].against->quantity == "shear_displacement");
    CHECK(e[4].measure == "max");
    CHECK(e[5].at == 0.5);
    CHECK(e[6].measure == "max");
    CHECK(e[6].probe.quantity == "relative_displacement");
    CHECK(e[6].below == 1e-3);
    CHECK(e[7].probe.quantity == "displacement");
    CHECK(e[7].above == 0.1);
    CHECK(e[7].where.line == e[0].where.line + 7);
}

TEST_CASE("an override changes a key, creates one that is allowed, and is noted in the text") {
    const Scenario s = read(full_scenario, {"joints.bedding.friction_angle_deg=25", "rock.joint_sets[1].spacing.mean=4",
                                            "run.damping.local=0.1", "blocks.2.outline=[[0, 0], [9, 0], [0, 9]]"});
    CHECK(s.joints[0].friction_angle == Approx(25 * degree));
    CHECK(s.rock->joint_sets[1].spacing.mean == 4.0);
    CHECK(s.run.damping.local == 0.1);
    CHECK(block(s, "plate").outline.size() == 3);
    CHECK(s.text.find("# --set run.damping.local=0.1") != std::string::npos);
    CHECK(s.hash != read(full_scenario).hash);
}

TEST_CASE("every case is the scenario with its own keys and expectations") {
    const std::string text =
        small_scenario + R"(expect: [{quantity: rotation, block: cube, value: 0, tolerance_absolute: 1e-9}]
cases:
  - {name: slow, set: {gravity: [0, -1]}}
  - set:
      blocks[0].velocity: [3, 0]
      run.until.time: 5
    expect: [{quantity: velocity, block: cube, value: 4, tolerance: 0.1}, {quantity: unbalanced, below: 9}]
)";
    const std::vector<Case> cases = read_cases_text(text, "test.yaml", "");
    REQUIRE(cases.size() == 2);
    CHECK(cases[0].name == "slow");
    CHECK(cases[0].scenario.gravity(0.0) == Vec2(0, -1));
    CHECK(cases[0].scenario.expect.at(0).probe.quantity == "rotation");
    CHECK(cases[1].name == "case2");
    CHECK(cases[1].scenario.gravity(0.0) == Vec2(0, -10));
    CHECK(cases[1].scenario.blocks[0].velocity == Vec2(3, 0));
    CHECK(cases[1].scenario.run.until.time == 5.0);
    CHECK(cases[1].scenario.expect.size() == 2);
    CHECK(cases[0].scenario.hash != cases[1].scenario.hash);

    const std::vector<Case> none = read_cases_text(small_scenario, "test.yaml", "");
    REQUIRE(none.size() == 1);
    CHECK(none[0].name.empty());
    CHECK(none[0].scenario.hash == read(small_scenario).hash);
}

TEST_CASE("far from the origin all coordinates are shifted exactly to the corner of the scene") {
    const auto at = [](double x, double y) {
        const auto p = [&](double dx, double dy) {
            return "[" + std::to_string(x + dx) + ", " + std::to_string(y + dy) + "]";
        };
        return "materials: {rock: {density: 2500}}\njoints: {j: {normal_stiffness: 1e9, shear_stiffness: 1e9}}\n"
               "rock:\n  outline: [" +
               p(0.5, 0.25) + ", " + p(8, 0.25) + ", " + p(8, 8) +
               "]\n"
               "  held: {below: " +
               std::to_string(y + 1) +
               "}\n"
               "  joint_sets: [{angle_deg: 0, spacing: 1, origin: " +
               p(2, 3) +
               "}]\n"
               "blocks: [{rectangle: {corner: " +
               p(2, 9) +
               ", size: [1, 1]}, repeat: {count: 2, step: [2, 0]}}]\n"
               "initial_stress: {stress: [1, 2, 3], gradient_y: [0, -4, 0]}\n"
               "run: {until: {time: 1}}\nexpect: [{quantity: stable, point: " +
               p(7, 1) + "}]\n";
    };
    const Scenario near = read(at(0, 0)), far = read(at(450000, 6500000));
    CHECK(near.origin == Vec2(0, 0));
    CHECK(far.origin == Vec2(450000, 6500000));
    CHECK(far.rock->outline == near.rock->outline);
    CHECK(far.rock->held.below == near.rock->held.below);
    CHECK(far.rock->joint_sets[0].origin == near.rock->joint_sets[0].origin);
    CHECK(far.blocks.at(1).outline == near.blocks.at(1).outline);
    CHECK(*far.expect[0].probe.point == *near.expect[0].probe.point);
    CHECK((*far.initial_stress->stress)[1] == 2.0 - 4.0 * 6500000);  // the same field at the new origin
    CHECK(read(at(450000, 6500000) + "origin: [450001, 0]\n").origin == Vec2(450001, 0));
}

TEST_CASE("the canonical JSON holds every default and reads as the same scenario") {
    const Scenario s = read(full_scenario);
    const Scenario again = read(s.canonical_json);
    CHECK(again.canonical_json == s.canonical_json);
    CHECK(again.hash == s.hash);
    CHECK(again.blocks.size() == s.blocks.size());
    // What refers to joints and materials by number means the same, and so does the order of regions that overlap.
    for (std::size_t i = 0; i < s.joints.size(); ++i) CHECK(again.joints.at(i).name == s.joints[i].name);
    for (std::size_t i = 0; i < s.materials.size(); ++i) CHECK(again.materials.at(i).name == s.materials[i].name);
    for (std::size_t i = 0; i < s.rock->regions.size(); ++i)
        CHECK(again.rock->regions.at(i).name == s.rock->regions[i].name);
    CHECK(s.canonical_json.find(R"("step_fraction":0.80000000000000004)") != std::string::npos);
    CHECK(s.canonical_json.find(R"("default":"floor")") != std::string::npos);
}

TEST_CASE("order of keys, comments and spelling of numbers do not change the hash") {
    const std::string other = R"(run: {until: {time: 1.0}}   # as small_scenario
materials: {rock: {density: 2.5e3}}
gravity: [0, -1e1]
blocks:
- outline: [[0, 0], [1, 0], [1, 1], [0, 1.]]
  name: "cube"
)";
    CHECK(read(other).hash == read(small_scenario).hash);
    CHECK(read(other + "title: x\n").hash != read(small_scenario).hash);
}
