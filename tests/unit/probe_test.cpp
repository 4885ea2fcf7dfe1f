#include "model/probe.hpp"
#include "support/catch.hpp"

#include <cmath>
#include <numbers>

using namespace talus;

namespace {

/// A base of 4 x 1 m with its top at y = 0, and on it a block of 2 x 1 m between x = 0 and x = 2.
struct Bench {
    Model model;
    State state;

    Bench() {
        model.joints.push_back(Joint{});
        model.parts.first_corner.push_back(0);
        model.blocks.first_part.push_back(0);
        add("base", {1.0, -0.5}, {4.0, 1.0}, 0.0);
        add("block", {1.0, 0.5}, {2.0, 1.0}, 5000.0);
    }
    void add(const std::string& name, const Vec2& centre, const Vec2& size, double mass) {
        const Vec2 half = 0.5 * size;
        const Vec2 arms[] = {-half, {half.x(), -half.y()}, half, {-half.x(), half.y()}};
        const Vec2 normals[] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
        const double lengths[] = {size.x(), size.y(), size.x(), size.y()};
        for (int k = 0; k < 4; ++k) {
            model.corners.arm.push_back(arms[k]);
            model.corners.normal.push_back(normals[k]);
            model.corners.offset.push_back(normals[k].dot(arms[k]));
            model.corners.length.push_back(lengths[k]);
            model.corners.internal.push_back(0);
        }
        model.parts.block.push_back(model.blocks.size());
        model.parts.first_corner.push_back(model.corners.size());
        model.parts.thickness.push_back(size.y());
        model.blocks.first_part.push_back(model.parts.size());
        model.blocks.mass.push_back(mass);
        model.blocks.inertia.push_back(mass / 12.0 * size.squaredNorm());
        model.blocks.area.push_back(size.x() * size.y());
        const double inverse = mass > 0.0 ? 1.0 / mass : 0.0;
        model.blocks.inv_mass.push_back({inverse, inverse});
        model.blocks.inv_inertia.push_back(mass > 0.0 ? 1.0 / model.blocks.inertia.back() : 0.0);
        model.blocks.start.push_back(centre);
        model.blocks.material.push_back(0);
        model.blocks.region.push_back(-1);
        model.blocks.name.push_back(name);
        for (auto* positions : {&state.motion.position, &state.start_position}) positions->push_back(centre);
        for (auto* angles : {&state.motion.angle, &state.start_angle, &state.motion.spin}) angles->push_back(0.0);
        state.motion.velocity.push_back(Vec2::Zero());
        state.load.push_back({});
        state.removed.push_back(0);
    }
    void press(double force, double shear, double length, const Vec2& centre_of_pressure) {
        state.contacts.list = {{.part_a = 0,
                                .part_b = 1,
                                .joint = 0,
                                .edge_b = 4,
                                .touching = 1,
                                .length = length,
                                .normal_force = force,
                                .shear_force = shear,
                                .point = centre_of_pressure,
                                .normal = {0, 1}}};
        state.contacts.reaction = {{{-shear, force}, -1.0, 2.0}};
    }
    double read(const ProbeSpec& spec) const { return make_probe(spec, model, state).read(model, state, {}); }
};

ProbeSpec at_joint(const std::string& quantity) {
    ProbeSpec spec;
    spec.quantity = quantity;
    spec.joint = Vec2(1.0, 0.0);
    return spec;
}

ProbeSpec at_point(const std::string& quantity, const std::string& component, const Vec2& point) {
    ProbeSpec spec;
    spec.quantity = quantity;
    spec.component = component;
    spec.point = point;
    return spec;
}

}  // namespace

TEST_CASE("a point follows the block that contained it, also where the block turns") {
    Bench bench;
    const Probe height = make_probe(at_point("displacement", "y", {2.0, 0.5}), bench.model, bench.state);
    const Probe speed = make_probe(at_point("velocity", "y", {2.0, 0.5}), bench.model, bench.state);
    bench.state.motion.position[1] += Vec2(10.0, 3.0);
    bench.state.motion.angle[1] = std::numbers::pi / 2;  // the point is now 1 m above the centroid
    bench.state.motion.velocity[1] = {0.0, 4.0};
    bench.state.motion.spin[1] = 0.5;
    CHECK(height.read(bench.model, bench.state, {}) == Approx(4.0).epsilon(1e-14));
    CHECK(speed.read(bench.model, bench.state, {}) == Approx(4.0).epsilon(1e-14));
    bench.state.start_position[1] = bench.state.motion.position[1];
    bench.state.start_angle[1] = bench.state.motion.angle[1];
    CHECK(std::abs(height.read(bench.model, bench.state, {})) < 1e-15);  // after a reset it counts from zero
}

TEST_CASE("a component along a direction is the projection on it") {
    Bench bench;
    bench.state.motion.velocity[1] = {1.0, -2.0};
    ProbeSpec spec = at_point("velocity", "along", {1.0, 0.5});
    spec.direction = radians(-30.0);
    CHECK(bench.read(spec) == Approx(std::cos(radians(30.0)) + 2.0 * std::sin(radians(30.0))));
    spec.component = "magnitude";
    CHECK(bench.read(spec) == Approx(std::sqrt(5.0)));
}

TEST_CASE("the largest stress on a face follows the eccentricity, pressed all over or partly open") {
    Bench bench;
    const double force = 1e5;
    const auto largest = [&](double eccentricity, double length) {
        bench.press(force, 0.0, length, {1.0 + eccentricity, 0.0});
        return bench.read(at_joint("max_normal_stress"));
    };
    CHECK(largest(0.0, 2.0) == Approx(50e3));
    CHECK(largest(0.1, 2.0) == Approx(65e3));
    CHECK(largest(-0.2, 2.0) == Approx(80e3));
    CHECK(largest(0.5, 1.5) == Approx(133333.333));
    CHECK(largest(0.7, 0.9) == Approx(222222.222));
    bench.state.motion.angle[1] = radians(30.0);  // no longer face to face: a corner, pressed like a wedge
    CHECK(largest(0.0, 0.01) == Approx(2e7));
}

TEST_CASE("stresses are forces over the loaded length, utilisation is shear over strength") {
    Bench bench;
    bench.press(3e5, -1e5, 1.5, {1.0, 0.0});
    CHECK(bench.read(at_joint("normal_stress")) == Approx(2e5));
    CHECK(bench.read(at_joint("shear_stress")) == Approx(-1e5 / 1.5));
    bench.state.contacts.list[0].strength = 4e5;
    CHECK(bench.read(at_joint("utilisation")) == 0.25);
}

TEST_CASE("an open joint carries nothing but still tells how far it has opened and sheared") {
    Bench bench;
    const Probe opening = make_probe(at_joint("opening"), bench.model, bench.state);
    const Probe shear = make_probe(at_joint("shear_displacement"), bench.model, bench.state);
    bench.state.motion.position[1] += Vec2(-0.02, 0.01);  // to the left of the upward normal
    CHECK(bench.read(at_joint("normal_force")) == 0.0);
    CHECK(opening.read(bench.model, bench.state, {}) == Approx(0.01));
    CHECK(shear.read(bench.model, bench.state, {}) == Approx(0.02));
}

TEST_CASE("a reaction is the sum of the contact forces on the block") {
    Bench bench;
    bench.press(3e5, -1e5, 1.5, {1.0, 0.0});
    CHECK(bench.read(at_point("reaction", "y", {1.0, 0.5})) == 3e5);
    CHECK(bench.read(at_point("reaction", "x", {1.0, 0.5})) == 1e5);
    CHECK(bench.read(at_point("moment", "", {1.0, 0.5})) == 2.0);
    CHECK(bench.read(at_point("reaction", "y", {-0.5, -0.5})) == -3e5);
}

TEST_CASE("angular momentum counts both the path of the centroid and the spin") {
    Bench bench;
    bench.state.motion.velocity[1] = {0.0, 2.0};
    bench.state.motion.spin[1] = 3.0;
    ProbeSpec spec;
    spec.quantity = "angular_momentum";
    CHECK(bench.read(spec) == Approx(5000.0 * 1.0 * 2.0 + 5000.0 / 12.0 * 5.0 * 3.0));
    spec.quantity = "momentum";
    spec.component = "y";
    CHECK(bench.read(spec) == 1e4);
    // What is driven along an axis has the momentum that drives it, and is not free.
    bench.model.blocks.inv_mass[1].y() = 0.0;
    CHECK(bench.read(spec) == 0.0);
}

TEST_CASE("energy drift is the change of the total since the last reset over the largest energy that moved") {
    Bench bench;
    ProbeSpec spec;
    spec.quantity = "energy_drift";
    const Probe drift = make_probe(spec, bench.model, bench.state);
    REQUIRE(drift.needs_energies);
    CHECK(drift.read(bench.model, bench.state, {.energies = {.strain_normal = 100.0}}) == 0.0);
    bench.state.step = 1;
    CHECK(drift.read(bench.model, bench.state, {.energies = {.kinetic = 900.0, .strain_normal = 101.0, .gravity = 900.0}}) ==
          Approx(1.0 / 900.0));
}

TEST_CASE("relative displacement is counted in sizes of the block, and of the largest mover when no place is given") {
    Bench bench;
    bench.state.motion.position[1] += Vec2(0.3, 0.4);
    ProbeSpec spec;
    spec.quantity = "relative_displacement";
    CHECK(bench.read(spec) == Approx(0.5 / std::sqrt(2.0)));
    spec.block = "base";
    CHECK(bench.read(spec) == 0.0);
    spec.block.clear();
    spec.quantity = "max_displacement";
    CHECK(bench.read(spec) == Approx(0.5));
}

TEST_CASE("what cannot be observed is refused") {
    const Bench bench;
    CHECK_THROWS_AS(bench.read(at_point("displacement", "x", {50.0, 50.0})), InputError);
    CHECK_THROWS_AS(bench.read(at_point("displacement", "z", {1.0, 0.5})), InputError);
    CHECK_THROWS_AS(bench.read(at_point("temperature", "", {1.0, 0.5})), InputError);
    ProbeSpec unnamed;
    unnamed.quantity = "spin";
    CHECK_THROWS_AS(bench.read(unnamed), InputError);
    unnamed.block = "keystone";
    CHECK_THROWS_AS(bench.read(unnamed), InputError);
}
