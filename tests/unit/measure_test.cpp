#include "model/measure.hpp"
#include "model/material_point.hpp"

#include "model/build.hpp"
#include "model/hash.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

#include <limits>
#include <numbers>

using namespace talus;
using namespace talus::scenes;

namespace {

Scene pair_on_base() {
    return build(with({held(block("base", rectangle(-1, -1, 5, 0))), block("a", rectangle(0, 0, 2, 1)),
                       block("b", rectangle(2, 0, 4, 1))}));
}

Selector named(const std::string& name) {
    Selector s;
    s.block = name;
    return s;
}

}  // namespace

TEST_CASE("kinetic energy counts the free axes of blocks that are still there") {
    Scene scene = pair_on_base();
    scene.state.motion.velocity[1] = {3.0, 4.0};
    scene.state.motion.spin[1] = 2.0;
    const double inertia = 5000.0 * 5.0 / 12.0;
    CHECK(kinetic_energy(scene.model, scene.state) == Approx(0.5 * 5000.0 * 25.0 + 0.5 * inertia * 4.0));
    scene.state.motion.velocity[0] = {9.0, 9.0};  // a held block has none
    CHECK(kinetic_energy(scene.model, scene.state) == Approx(0.5 * 5000.0 * 25.0 + 0.5 * inertia * 4.0));
    scene.state.removed[1] = 1;
    CHECK(kinetic_energy(scene.model, scene.state) == 0.0);
}

TEST_CASE("the unbalanced ratio is one in free fall and zero in equilibrium") {
    Scene scene = pair_on_base();
    CHECK(unbalanced_ratio(scene.model, scene.state) == 0.0);
    for (BlockId b = 1; b < 3; ++b) scene.state.load[b].force = {0.0, -10.0 * scene.model.blocks.mass[b]};
    CHECK(unbalanced_ratio(scene.model, scene.state) == Approx(1.0));
}

TEST_CASE("the unbalanced ratio does not see held axes and weighs torques by the radius of gyration") {
    Scene scene = pair_on_base();
    scene.state.load[0].force = {1e9, 1e9};
    CHECK(unbalanced_ratio(scene.model, scene.state) == 0.0);
    const double gyration = std::sqrt(5.0 / 12.0);  // of a rectangle 2 x 1
    scene.state.load[1].torque = 50000.0 * gyration;
    CHECK(unbalanced_ratio(scene.model, scene.state) == Approx(1.0));
    scene.model.blocks.inv_inertia[1] = 0.0;
    CHECK(unbalanced_ratio(scene.model, scene.state) == 0.0);
}

TEST_CASE("the unbalanced ratio is the same with and without local damping") {
    Scene scene = pair_on_base();
    scene.state.load[1].force = {0.0, -50000.0 + 40000.0};
    scene.state.load[1].torque = 7.0;
    scene.state.damping.assign(3, {});
    scene.state.damping[1] = {Vec2(0.0, 40000.0), 7.0};
    CHECK(unbalanced_ratio(scene.model, scene.state) == Approx(1.0));
}

TEST_CASE("the unbalanced ratio is measured against contact forces when they are larger than the weights") {
    Scene scene = pair_on_base();
    scene.state.load[1].force = {1e5, 0.0};
    Contact contact{.part_a = 1, .part_b = 2, .joint = 0};
    scene.state.contacts.list = {contact};
    scene.state.contacts.reaction = {{Vec2(3e5, 4e5), 0.0, 0.0}};
    CHECK(unbalanced_ratio(scene.model, scene.state) == Approx(1e5 / 5e5));
    scene.model.gravity_y = TimeTable::constant(0.0);
    scene.state.contacts = {};
    CHECK(unbalanced_ratio(scene.model, scene.state) == std::numeric_limits<double>::infinity());
}

TEST_CASE("displacement follows a point of the block through translation and rotation") {
    Scene scene = pair_on_base();
    State& state = scene.state;
    const MaterialPoint corner = fixed_to(state, 1, {2.0, 1.0}), middle = fixed_to(state, 1, {1.0, 0.5});
    state.motion.position[1] += Vec2(0.5, 0.25);
    state.motion.angle[1] = std::numbers::pi / 2;
    // The corner (2, 1) is (1, 0.5) from the centroid and goes to (-0.5, 1): moved by (-1.5, 0.5) besides the translation.
    CHECK((corner.displacement(state) - Vec2(-1.0, 0.75)).norm() < 1e-15);
    CHECK(middle.displacement(state) == Vec2(0.5, 0.25));
}

TEST_CASE("displacement counts from the last reset") {
    Scene scene = pair_on_base();
    State& state = scene.state;
    state.motion.position[1] = {7.0, 3.0};
    state.motion.angle[1] = 0.3;
    state.start_position = state.motion.position;
    state.start_angle = state.motion.angle;
    const MaterialPoint point = fixed_to(state, 1, {8.0, 3.0});
    CHECK(point.displacement(state) == Vec2(0.0, 0.0));
    state.motion.angle[1] += 1e-9;
    CHECK(point.displacement(state).y() == Approx(1e-9).epsilon(1e-6));
}

TEST_CASE("the fastest point of a spinning block is its farthest corner") {
    Scene scene = pair_on_base();
    CHECK(max_speed(scene.model, scene.state) == 0.0);
    scene.state.motion.velocity[1] = {1.0, 0.0};
    scene.state.motion.spin[1] = -2.0;
    CHECK(max_speed(scene.model, scene.state) == Approx(1.0 + 2.0 * std::hypot(1.0, 0.5)));
}

TEST_CASE("a point is found in the block where it is now") {
    Scene scene = pair_on_base();
    CHECK(block_at(scene.model, scene.state, {3.0, 0.5}) == 2);
    CHECK(block_at(scene.model, scene.state, {2.0, 0.5}) == 1);  // on the common edge: the first
    CHECK(block_at(scene.model, scene.state, {3.0, 4.5}) == -1);
    scene.state.motion.position[2] += Vec2(0.0, 4.0);
    scene.state.motion.angle[2] = std::numbers::pi / 2;
    CHECK(block_at(scene.model, scene.state, {3.0, 4.5}) == 2);
    CHECK(block_at(scene.model, scene.state, {3.9, 4.5}) == -1);  // it stands upright now
    CHECK(block_at(scene.model, scene.state, {3.0, 5.4}) == 2);
    scene.state.removed[2] = 1;
    CHECK(block_at(scene.model, scene.state, {3.0, 4.5}) == -1);
}

TEST_CASE("blocks are selected by name, by a point at the start and by an outline around the centroid") {
    Scene scene = pair_on_base();
    scene.state.motion.position[2] += Vec2(100.0, 0.0);  // where it is now plays no part
    CHECK(select(scene.model, scene.state, named("b")) == std::vector<BlockId>{2});
    Selector at, inside;
    at.at = Vec2(3.0, 0.5);
    CHECK(select(scene.model, scene.state, at) == std::vector<BlockId>{2});
    inside.inside = rectangle(0, 0, 10, 10);
    CHECK(select(scene.model, scene.state, inside) == std::vector<BlockId>{1, 2});
    scene.state.removed[1] = 1;
    CHECK(select(scene.model, scene.state, inside) == std::vector<BlockId>{2});
    CHECK_THROWS_AS(select(scene.model, scene.state, named("a")), InputError);
    at.at = Vec2(50.0, 50.0);
    CHECK_THROWS_AS(select(scene.model, scene.state, at), InputError);
    Selector region;
    region.region = "unknown";
    CHECK_THROWS_AS(select(scene.model, scene.state, region), InputError);
}

TEST_CASE("a load with a point acts on the arm from the centroid") {
    Scenario scene = with({block("a", rectangle(0, 0, 2, 1))});
    scene.loads.resize(1);
    scene.loads[0].block.block = "a";
    scene.loads[0].force = {TimeTable{{0.0, 2.0}, {0.0, 8.0}}, TimeTable::constant(5.0)};
    scene.loads[0].point = Vec2(2.0, 1.0);
    const Model m = build(scene).model;
    REQUIRE(m.loads.size() == 1);
    CHECK(m.boundary_loads == 0);
    CHECK(m.loads[0].arm == Vec2(1.0, 0.5));
    CHECK(m.loads[0].force_x(1.0) == 4.0);
    CHECK(m.loads[0].force_y(1.0) == 5.0);
    CHECK(m.loads[0].moment(1.0) == 0.0);
}

TEST_CASE("gravity and body acceleration act together") {
    Scenario scene = with({block("a", rectangle(0, 0, 2, 1))});
    scene.gravity.y = TimeTable{{0.0, 2.0}, {0.0, -10.0}};
    scene.body_acceleration.x = TimeTable::constant(3.0);
    scene.body_acceleration.y = TimeTable{{1.0, 3.0}, {0.0, 4.0}};
    const Model m = build(scene).model;
    CHECK(m.gravity_x(7.0) == 3.0);
    CHECK(m.gravity_y(0.0) == 0.0);
    CHECK(m.gravity_y(1.0) == Approx(-5.0));
    CHECK(m.gravity_y(1.5) == Approx(-7.5 + 1.0));
    CHECK(m.gravity_y(2.5) == Approx(-10.0 + 3.0));
    CHECK(m.gravity_y(9.0) == Approx(-6.0));
}

TEST_CASE("the hash of a state sees motion, contact memory and broken bonds, but not the sign of zero") {
    Scene scene = pair_on_base();
    const auto hash = [&] { return state_hash(scene.model, scene.state); };
    const std::uint64_t first = hash();
    scene.state.motion.spin[1] = -0.0;
    CHECK(hash() == first);
    scene.state.motion.spin[1] = 1e-300;
    CHECK(hash() != first);
    scene.state.motion.spin[1] = 0.0;

    scene.state.contacts.list = {Contact{.part_a = 1, .part_b = 2, .joint = 0}};
    CHECK(hash() == first);  // not alive
    scene.state.contacts.list[0].alive = 1;
    const std::uint64_t with_contact = hash();
    CHECK(with_contact != first);
    scene.state.contacts.list[0].slip_sum = -1e-9;
    CHECK(hash() != with_contact);
    scene.state.contacts.list.clear();
    scene.state.contacts.broken = {0};
    const std::uint64_t intact = hash();
    scene.state.contacts.broken = {2};
    CHECK(hash() != intact);
    scene.state.contacts.broken.clear();
    scene.state.step = 1;
    CHECK(hash() != first);
}
