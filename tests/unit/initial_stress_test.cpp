// A rock in equilibrium with its in-situ stress: for every block the forces of all its faces, the dead loads on the free
// sides of the rock and the weight add up to nothing, and so do their moments. That is the divergence theorem, and it
// decides every sign: of the normal, of the shear, of the side loads.
#include "contact/contacts.hpp"
#include "dynamics/motion.hpp"
#include "model/build.hpp"
#include "model/measure.hpp"
#include "scenario/reader.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

#include <algorithm>
#include <cmath>

using namespace talus;
using namespace talus::scenes;

namespace {

constexpr double unit_weight = 2500.0 * 10.0;  // N/m3

// Force and moment of a joint face on its second block, integrated from the two end stresses (linear between them).
Force on_second(const Model& m, const JointFace& face, double shear_force) {
    const BlockId b = m.parts.block[face.part_b];
    const Vec2 n = m.corners.normal[face.edge_a], along = perp(n);
    const double length = face.s1 - face.s0;
    Force sum;
    for (const double share : {0.5 - std::sqrt(1.0 / 12.0), 0.5 + std::sqrt(1.0 / 12.0)}) {  // Gauss: exact to third order
        const Vec2 arm = m.blocks.start[m.parts.block[face.part_a]] + m.corners.arm[face.edge_a] +
                         (face.s0 + share * length) * along - m.blocks.start[b];
        const double sigma = face.sigma0 + share * (face.sigma1 - face.sigma0);
        const Vec2 f = 0.5 * (sigma * length * n + shear_force * along);
        sum.force += f;
        sum.torque += cross(arm, f);
    }
    REQUIRE(b < m.blocks.size());
    return sum;
}

struct Balance {
    double force = 0.0, moment = 0.0;  // largest of all free blocks, relative to the sum of magnitudes
};

Balance imbalance(const Scene& built) {
    const Model& m = built.model;
    const int nb = m.blocks.size();
    std::vector<Force> sum(nb);
    std::vector<double> scale(nb, 0.0), arm_scale(nb, 0.0);
    const auto add = [&](BlockId b, const Vec2& f, double moment) {
        sum[b].force += f;
        sum[b].torque += moment;
        scale[b] += f.norm();
        arm_scale[b] += f.norm() * std::sqrt(m.blocks.area[b]);
    };
    for (std::size_t i = 0; i < m.faces.size(); ++i) {
        const JointFace& face = m.faces[i];
        const BlockId a = m.parts.block[face.part_a], b = m.parts.block[face.part_b];
        const Force f = on_second(m, face, built.state.contacts.list[i].shear_force);
        add(b, f.force, f.torque);
        add(a, -f.force, -(f.torque + cross(m.blocks.start[b] - m.blocks.start[a], f.force)));
    }
    for (const Load& load : m.loads) {
        const Vec2 f(load.force_x(0), load.force_y(0));
        add(load.block, f, cross(load.arm, f) + load.moment(0));
    }
    for (BlockId b = 0; b < nb; ++b) add(b, m.blocks.mass[b] * Vec2(m.gravity_x(0), m.gravity_y(0)), 0.0);

    Balance worst;
    for (BlockId b = 0; b < nb; ++b) {
        if (m.blocks.held(b)) continue;
        worst.force = std::max(worst.force, sum[b].force.norm() / scale[b]);
        worst.moment = std::max(worst.moment, std::abs(sum[b].torque) / arm_scale[b]);
    }
    return worst;
}

Scenario stressed_rock(std::vector<JointSetSpec> sets, double k0) {
    Scenario scene = rock(rectangle(0, 0, 20, 12), std::move(sets));
    scene.initial_stress.emplace();
    scene.initial_stress->k0 = k0;
    return scene;
}

BlockSpec base(double x0, double x1, double y1) { return held(block("base", rectangle(x0, y1 - 1, x1, y1))); }

}  // namespace

TEST_CASE("a column of blocks carries the weight of what lies above") {
    Scenario scene = with({base(0, 2, 0), block("low", rectangle(0, 0, 2, 1)), block("high", rectangle(0, 1, 2, 3))});
    scene.initial_stress.emplace();
    scene.initial_stress->k0 = 0.5;
    const Scene built = build(scene);
    REQUIRE(built.model.faces.size() == 2);
    CHECK(built.model.faces[0].sigma0 == Approx(3 * unit_weight));
    CHECK(built.model.faces[0].sigma1 == Approx(3 * unit_weight));
    CHECK(built.model.faces[1].sigma0 == Approx(2 * unit_weight));
    CHECK_FALSE(built.model.faces[1].bonded);
    const Contact& contact = built.state.contacts.list[0];
    CHECK(contact.touching == 1);
    CHECK(contact.alive == 1);
    CHECK(contact.length == Approx(2.0));
    CHECK(contact.normal_force == Approx(6 * unit_weight));
    CHECK(contact.shear_force == 0.0);
    CHECK((contact.point - Vec2(1, 0)).norm() < 1e-15);
    CHECK((contact.normal - Vec2(0, 1)).norm() < 1e-15);  // from the base, block 0, to the block above
    CHECK(imbalance(built).force < 1e-14);
}

TEST_CASE("a vertical face carries K0 times the vertical stress, at its centre of pressure") {
    Scenario scene = with({block("left", rectangle(0, 0, 2, 3)), block("right", rectangle(2, 0, 4, 3))});
    scene.initial_stress.emplace();
    scene.initial_stress->k0 = 2.0;
    scene.initial_stress->surface = 3.0;
    const Scene built = build(scene);
    REQUIRE(built.model.faces.size() == 1);
    const JointFace& face = built.model.faces[0];
    CHECK(face.sigma0 == Approx(2.0 * 3 * unit_weight));  // edge of the left block runs upwards
    CHECK(face.sigma1 == 0.0);
    CHECK(built.state.contacts.list[0].normal_force == Approx(2.0 * unit_weight * 9.0 / 2.0));
    CHECK((built.state.contacts.list[0].point - Vec2(2.0, 1.0)).norm() < 1e-14);
}

TEST_CASE("an inclined face carries the traction of Cauchy with the right sign of shear") {
    // Face from (0, 0) to (4, 4) between a lower block a and an upper block b, constant stress xx = 1, yy = 3, xy = 0.5 MPa.
    // n = (-1, 1)/sqrt(2): S n = (-0.5, 2.5)/sqrt(2) MPa, n.Sn = 1.5, perp(n) = (-1, -1)/sqrt(2), perp(n).Sn = -1 MPa.
    Scenario scene = with({block("lower", {{0, 0}, {4, 0}, {4, 4}}), block("upper", {{0, 0}, {4, 4}, {0, 4}})});
    scene.initial_stress.emplace();
    scene.initial_stress->stress = Eigen::Vector3d(1e6, 3e6, 0.5e6);
    const Scene built = build(scene);
    REQUIRE(built.model.faces.size() == 1);
    const JointFace& face = built.model.faces[0];
    CHECK(face.sigma0 == Approx(1.5e6));
    CHECK(face.sigma1 == Approx(1.5e6));
    CHECK(built.state.contacts.list[0].shear_force == Approx(-1e6 * 4 * std::sqrt(2.0)));
}

TEST_CASE("stress given for a joint goes before the field") {
    Scenario scene =
        with({block("a", rectangle(0, 0, 2, 1)), block("b", rectangle(0, 1, 2, 2)), block("c", rectangle(0, 2, 2, 3))});
    scene.joints.push_back(joint("seam"));
    scene.contacts.blocks = {{"a", "b", "seam"}};
    scene.initial_stress.emplace();
    scene.initial_stress->joints = {{"seam", 4e5, -1e5}};
    Scene built = build(scene);
    REQUIRE(built.model.faces.size() == 1);  // no field: the other face carries nothing
    CHECK(built.model.faces[0].sigma0 == 4e5);
    CHECK(built.model.faces[0].sigma1 == 4e5);
    CHECK(built.state.contacts.list[0].shear_force == Approx(-2e5));
    scene.initial_stress->k0 = 1.0;
    built = build(scene);
    REQUIRE(built.model.faces.size() == 2);
    CHECK(built.model.faces[0].sigma0 == 4e5);
    CHECK(built.model.faces[1].sigma0 == Approx(unit_weight));
    scene.initial_stress->joints = {{"nowhere", 1.0, 0.0}};
    CHECK_THROWS_AS(build(scene), InputError);
}

TEST_CASE("a jointed rock under its K0 stress is in balance, whatever the joint sets") {
    const std::vector<std::vector<JointSetSpec>> layouts{{joint_set(0, 1.5), joint_set(90, 2.0)},
                                                         {joint_set(-35, 1.3), joint_set(70, 1.7)},
                                                         {joint_set(12, 0.9), joint_set(48, 1.1), joint_set(-66, 2.3)}};
    for (const auto& sets : layouts)
        for (const double k0 : {0.3, 1.0, 2.5}) {
            Scenario scene = stressed_rock(sets, k0);
            scene.initial_stress->left = scene.initial_stress->right = scene.initial_stress->bottom = true;
            const Scene built = build(scene);
            CHECK(built.model.blocks.size() > 40);
            CHECK(built.model.boundary_loads > 0);
            CHECK(imbalance(built).force < 1e-12);
            CHECK(imbalance(built).moment < 1e-12);
        }
}

TEST_CASE("contact geometry and joint law find a rock under its in-situ stress at rest") {
    for (const double k0 : {0.5, 2.0}) {
        Scenario scene = stressed_rock({joint_set(-35, 1.3), joint_set(70, 1.7)}, k0);
        scene.joints[0].friction_angle = radians(60.0);
        scene.initial_stress->left = scene.initial_stress->right = scene.initial_stress->bottom = true;
        Scene built = build(scene);
        CHECK(built.report.warnings.empty());
        const Model& m = built.model;
        State& state = built.state;
        std::vector<Pair> pairs;
        for (PartId a = 0; a < m.parts.size(); ++a)
            for (PartId b = a + 1; b < m.parts.size(); ++b) pairs.push_back({a, b});
        Placed placed;
        ContactIndex index;
        const Awake all = all_awake(m.blocks.size());
        place(m, all, state.motion, 0.0, placed);
        refresh_contacts(m, placed, pairs, std::vector<std::uint8_t>(m.blocks.size(), 1), 0.0, state, index);
        update_contacts(m, placed, 0.0, Pace::all, state, index);
        weigh(m, all.loaded, state, state.load);
        add_loads(m, state, Pace::all, state.load);
        sum_contacts(all.loaded, state.contacts, index, state.load);
        // Blocks fit to 1e-15 m or so, and a joint of 1e10 Pa/m turns that into 1e-5 Pa; the stress is 1e5 Pa.
        CHECK(unbalanced_ratio(m, state) < 1e-9);
    }
}

TEST_CASE("a field with shear and gradients that satisfy equilibrium is in balance on all four sides") {
    // div S = (0, -unit weight): xx = 2e6 + 1e4 x - 3e4 y, xy = 3e5 - 1e4 y + 2e3 x, yy = 1e6 - (unit weight + 2e3) y.
    Scenario scene = stressed_rock({joint_set(-35, 1.3), joint_set(70, 1.7)}, 1.0);
    scene.initial_stress->k0.reset();
    scene.initial_stress->stress = Eigen::Vector3d(2e6, 1e6, 3e5);
    scene.initial_stress->gradient_x = Eigen::Vector3d(1e4, 0.0, 2e3);
    scene.initial_stress->gradient_y = Eigen::Vector3d(-3e4, -(unit_weight + 2e3), -1e4);
    scene.initial_stress->left = scene.initial_stress->right = scene.initial_stress->bottom = scene.initial_stress->top =
        true;
    const Scene built = build(scene);
    CHECK(imbalance(built).force < 1e-12);
    CHECK(imbalance(built).moment < 1e-12);
}

TEST_CASE("a surcharge needs its load on the top side") {
    Scenario scene = stressed_rock({joint_set(20, 1.3), joint_set(100, 1.7)}, 0.6);
    auto& stress = *scene.initial_stress;
    stress.surcharge = 5e5;
    stress.left = stress.right = stress.bottom = true;
    CHECK(imbalance(build(scene)).force > 0.01);
    stress.top = true;
    CHECK(imbalance(build(scene)).force < 1e-12);
}

TEST_CASE("stress on a side that no block reaches with an edge is refused") {
    Scenario scene = stressed_rock({joint_set(20, 1.3)}, 0.6);
    scene.rock->outline = {{0, 0}, {20, 0}, {18, 12}, {1, 11}};
    scene.initial_stress->left = scene.initial_stress->bottom = true;
    CHECK_THROWS_WITH(build(scene), Catch::Contains("initial_stress.left") && !Catch::Contains("initial_stress.bottom"));
}

TEST_CASE("balance holds far from the origin to the rounding of the coordinates") {
    Scenario scene = stressed_rock({joint_set(-35, 1.3), joint_set(70, 1.7)}, 0.5);
    const Vec2 away(4.5e5, 6.5e6);
    scene.rock->outline = shifted(scene.rock->outline, away);
    for (JointSetSpec& set : scene.rock->joint_sets) set.origin += away;
    scene.initial_stress->left = scene.initial_stress->right = scene.initial_stress->bottom = true;
    const Scene built = build(scene);
    CHECK(built.model.blocks.size() > 40);
    CHECK(imbalance(built).force < 1e-7);
    CHECK(imbalance(built).moment < 1e-7);
}

TEST_CASE("tension is dropped where the joint cannot pull and kept where it can, both with a word") {
    Scenario scene = with({block("a", rectangle(0, 0, 2, 1)), block("b", rectangle(0, 1, 2, 2))});
    scene.initial_stress.emplace();
    scene.initial_stress->stress = Eigen::Vector3d(0, -1e5, 0);
    scene.gravity = {};
    Scene built = build(scene);
    CHECK(built.model.faces.empty());
    REQUIRE(built.report.warnings.size() == 1);
    CHECK(built.report.warnings[0].find("no tension") != std::string::npos);

    scene.joints = {bonded_joint("plain", 0.0, 2e5)};
    built = build(scene);
    REQUIRE(built.model.faces.size() == 1);
    CHECK(built.model.faces[0].sigma0 == -1e5);
    CHECK(built.report.warnings.empty());
    scene.joints = {bonded_joint("plain", 0.0, 5e4)};
    CHECK(build(scene).report.warnings.at(0).find("beyond the strength") != std::string::npos);
}

TEST_CASE("a face at the surface carries nothing and gets no word, whatever the rounding") {
    // 0.1 + 0.2 is a little more than 0.3, so the upper bed lies above the surface by rounding.
    Scenario scene = with({held(block("a", rectangle(0, 0, 2, 0.1))), block("b", rectangle(0, 0.1, 2, 0.1 + 0.2)),
                           block("c", rectangle(0, 0.1 + 0.2, 2, 1))});
    scene.initial_stress.emplace();
    scene.initial_stress->k0 = 0.5;
    scene.initial_stress->surface = 0.3;
    const Scene built = build(scene);
    CHECK(built.model.faces.size() == 1);
    CHECK(built.report.warnings.empty());
}

TEST_CASE("shear beyond friction is told with the number of faces") {
    // Principal stresses 1 and 6 on a face at 45 degrees: shear / normal = 2.5 / 3.5 = 0.714, tan 30 = 0.577, tan 40 =
    // 0.839.
    Scenario scene = with({held(block("lower", {{0, 0}, {4, 0}, {4, 4}})), block("upper", {{0, 0}, {4, 4}, {0, 4}})});
    scene.initial_stress.emplace();
    scene.initial_stress->stress = Eigen::Vector3d(1e6, 6e6, 0);
    CHECK(build(scene).report.warnings.at(0).find("on 1 face(s)") != std::string::npos);
    scene.joints[0].friction_angle = radians(40.0);
    CHECK(build(scene).report.warnings.empty());
}

TEST_CASE("the field by default grows with the weight of the rock itself, not of what lies in a region of it") {
    const std::string scene = R"(
materials: {host: {density: 2500}, ore: {density: 5000}}
joints: {j: {normal_stiffness: 1e10, shear_stiffness: 5e9, friction_angle_deg: 40}}
rock:
  outline: [[0, 0], [10, 0], [10, 10], [0, 10]]
  material: host
  joint_sets: [{name: bed, angle_deg: 0, spacing: 2.5, origin: [0, 0], joint: j}]
  regions: {pocket: {outline: [[0, 0], [2, 0], [2, 2.5], [0, 2.5]], material: ore}}
  held: {bottom: true}
initial_stress: {k0: 1}
)";
    const auto built = [&](const std::string& rest) { return build(read_scenario_text(scene + rest, "f.yaml", ".")); };
    const auto largest = [](const Scene& of) {
        double most = 0.0;
        for (const JointFace& face : of.model.faces) most = std::max({most, face.sigma0, face.sigma1});
        return most;
    };
    const std::string runs = "\nrun: {until: {time: 1}}\n", ramp = "gravity: {time: [0, 1], x: [0, 0], y: [0, -10]}";
    // 7.5 m down, and 10 m down where the pocket stands between held rock and free rock.
    const double deepest = largest(built("gravity: [0, -10]" + runs));
    CHECK(deepest <= 10 * 25000.0 * (1 + 1e-12));
    CHECK(deepest >= 7.5 * 25000.0 * (1 - 1e-12));

    // The weight is that with which the run begins: of a static stage, that at the end of its table.
    const Scene weightless = built(ramp + runs);
    CHECK(largest(weightless) == 0.0);
    REQUIRE_FALSE(weightless.report.warnings.empty());
    CHECK_THAT(weightless.report.warnings.front(), Catch::Matchers::Contains("give initial_stress.unit_weight"));
    const Scene still = built(ramp + "\nrun: {solver: static, until: {equilibrium: 1e-6}}\n");
    CHECK(largest(still) == Approx(deepest).epsilon(1e-12));
    CHECK(still.report.warnings.empty());
}
