#include "model/build.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

#include <algorithm>
#include <numbers>
#include <set>

using namespace talus;
using namespace talus::scenes;

namespace {

Vec2 at(const Model& m, PartId p, int k) { return m.blocks.start[m.parts.block[p]] + m.corners.arm[k]; }

std::vector<std::string> held_names(const Model& model) {
    std::vector<std::string> names;
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        if (model.blocks.held(b)) names.push_back(model.blocks.name[b]);
    return names;
}

// A wall of `rows` courses of `columns` bricks 2 x 1, every second course set back by half a brick.
std::vector<BlockSpec> brick_wall(int rows, int columns) {
    std::vector<BlockSpec> wall;
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < columns; ++j) {
            const double x = 2.0 * j + (i % 2);
            wall.push_back(block("brick[" + std::to_string(i * columns + j) + "]", rectangle(x, i, x + 2.0, i + 1.0)));
        }
    return wall;
}

std::string report_of(const Scenario& scene) {
    try {
        build(scene);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("mass and inertia of a rectangle and of a triangle are those of the textbook") {
    const Model m = build(with({block("slab", rectangle(1, 2, 5, 4)), block("wedge", {{10, 0}, {13, 0}, {10, 3}})})).model;
    CHECK(m.blocks.mass[0] == Approx(2500.0 * 8.0));
    CHECK(m.blocks.inertia[0] == Approx(2500.0 * 8.0 * (16.0 + 4.0) / 12.0));  // m (w^2 + h^2) / 12
    CHECK((m.blocks.start[0] - Vec2(3, 3)).norm() < 1e-15);
    CHECK(m.blocks.area[1] == Approx(4.5));
    CHECK((m.blocks.start[1] - Vec2(11, 1)).norm() < 1e-14);
    CHECK(m.blocks.inertia[1] == Approx(2500.0 * 4.5 * (9.0 + 9.0) / 18.0));  // right triangle: m (a^2 + b^2) / 18
    CHECK(m.blocks.inv_inertia[1] * m.blocks.inertia[1] == Approx(1.0));
    CHECK(m.blocks.radius[0] == Approx(std::hypot(2.0, 1.0)));
    CHECK(m.parts.thickness[0] == Approx(2.0));
    CHECK(m.parts.thickness[1] == Approx(3.0 / std::numbers::sqrt2));
}

TEST_CASE("edges have outward unit normals, lengths and offsets that belong together") {
    const Model m = build(with({block("five", {{0, 0}, {4, 1}, {5, 3}, {2, 5}, {-1, 2}})})).model;
    REQUIRE(m.corners.size() == 5);
    for (int k = 0; k < 5; ++k) {
        const Vec2 edge = m.corners.arm[(k + 1) % 5] - m.corners.arm[k];
        CHECK(m.corners.normal[k].norm() == Approx(1.0));
        CHECK(std::abs(m.corners.normal[k].dot(edge)) < 1e-14);
        CHECK(m.corners.length[k] == Approx(edge.norm()));
        CHECK(m.corners.offset[k] > 0.0);  // the centroid is inside
        CHECK(m.corners.offset[k] == Approx(m.corners.normal[k].dot(m.corners.arm[(k + 1) % 5])));
    }
}

TEST_CASE("corners on a straight edge are removed") {
    const Model m = build(with({block("slab", {{0, 0}, {0.3, 0.1}, {3, 1}, {2, 4}, {0.5, 1}})})).model;
    CHECK(m.corners.size() == 3);  // (0.3, 0.1) lies on the first edge, (0.5, 1) on the last
}

TEST_CASE("a C-shaped block is one body of convex parts whose inner edges are marked") {
    const Polygon c{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {3, 2}, {3, 3}, {0, 3}};
    const Model m = build(with({block("c", c)})).model;
    REQUIRE(m.blocks.size() == 1);
    CHECK(m.parts.size() >= 3);
    CHECK(m.blocks.mass[0] == Approx(2500.0 * 7.0));
    // Three rectangles: 3x1 at (1.5, 0.5), 1x1 at (0.5, 1.5), 3x1 at (1.5, 2.5).
    const double x = (3 * 1.5 + 0.5 + 3 * 1.5) / 7.0;
    CHECK(m.blocks.start[0].x() == Approx(x));
    CHECK(m.blocks.start[0].y() == Approx(1.5));
    const double arms = 2 * 3 * ((1.5 - x) * (1.5 - x) + 1.0) + (0.5 - x) * (0.5 - x);
    CHECK(m.blocks.inertia[0] == Approx(2500.0 * (2 * 3 * (9 + 1) / 12.0 + 2 / 12.0 + arms)));

    double outer = 0.0;
    int inner = 0;
    for (int k = 0; k < m.corners.size(); ++k) m.corners.internal[k] ? void(++inner) : void(outer += m.corners.length[k]);
    CHECK(outer == Approx(3 + 1 + 2 + 1 + 2 + 1 + 3 + 3));
    CHECK(inner == 2 * (m.parts.size() - 1));
}

TEST_CASE("every two bricks of a wall that share a bed or a head joint get one face") {
    std::vector<BlockSpec> bricks = brick_wall(4, 5);
    Scenario scene = with(bricks);
    scene.joints = {bonded_joint("mortar", 1e5, 5e4)};
    scene.contacts.default_joint = "mortar";
    const Scene built = build(scene);
    // Head joints: 4 rows of 4. Bed joints: 3 pairs of courses; each brick but one at the end rests on two.
    CHECK(built.model.faces.size() == 4 * 4 + 3 * 9);
    CHECK(built.report.faces_per_joint == std::vector<int>{4 * 4 + 3 * 9});
    CHECK(built.state.contacts.list.size() == built.model.faces.size());
    CHECK(built.state.contacts.broken.size() == 2 * built.model.faces.size());

    double length = 0.0;
    for (std::size_t i = 0; i < built.model.faces.size(); ++i) {
        const JointFace& face = built.model.faces[i];
        const Model& m = built.model;
        CHECK(face.bonded);
        CHECK(face.part_a < face.part_b);
        if (i > 0) CHECK(std::pair(m.faces[i - 1].part_a, m.faces[i - 1].part_b) < std::pair(face.part_a, face.part_b));
        CHECK((m.corners.normal[face.edge_a] + m.corners.normal[face.edge_b]).norm() < 1e-15);
        // Its ends lie on edge b too.
        const Vec2 along = perp(m.corners.normal[face.edge_a]);
        const Vec2 on_a = at(m, face.part_a, face.edge_a) + face.s0 * along;
        const Vec2 b = at(m, face.part_b, face.edge_b);
        CHECK(std::abs(m.corners.normal[face.edge_b].dot(on_a - b)) < 1e-14);
        for (const double s : {face.s0, face.s1}) {
            const double on_b = (b - (on_a + (s - face.s0) * along)).dot(along);
            CHECK(on_b > -1e-14);
            CHECK(on_b < m.corners.length[face.edge_b] + 1e-14);
        }
        length += face.s1 - face.s0;
    }
    CHECK(length == Approx(4 * 4 * 1.0 + 3 * 9 * 1.0));
}

TEST_CASE("faces are found whatever the angle, and a bonded pair has exactly one") {
    for (const double angle : {0.0, 7.0, 31.4159, 45.0, 90.0, 133.7}) {
        std::vector<BlockSpec> bricks = brick_wall(6, 6);
        for (BlockSpec& brick : bricks) brick.outline = turned(brick.outline, angle);
        Scenario scene = with(bricks);
        scene.joints = {bonded_joint("mortar", 1e5, 0.0)};
        scene.contacts.default_joint = "mortar";
        const Model m = build(scene).model;
        CHECK(m.faces.size() == 6 * 5 + 5 * 11);
        std::set<std::pair<int, int>> pairs;
        for (const JointFace& face : m.faces) pairs.insert({face.part_a, face.part_b});
        CHECK(pairs.size() == m.faces.size());
    }
}

TEST_CASE("touching blocks need no face when their joint cannot pull and carries no stress") {
    const Scene scene = build(with(brick_wall(3, 3)));
    CHECK(scene.model.faces.empty());
    CHECK(scene.state.contacts.list.empty());
    CHECK(scene.report.faces_per_joint[0] == 3 * 2 + 2 * 5);
}

TEST_CASE("blocks that only meet at a corner do not touch along a face") {
    const Scene scene = build(with({block("a", rectangle(0, 0, 1, 1)), block("b", rectangle(1, 1, 2, 2)),
                                    block("c", {{-1, -1}, {0, -1}, {0, 0}}), block("d", rectangle(1.001, 0, 2, 0.9))}));
    CHECK(scene.report.faces_per_joint[0] == 0);
}

TEST_CASE("two held blocks have no face, a held and a driven one have") {
    Scenario scene = with({held(block("base", rectangle(0, 0, 4, 1))), held(block("wall", rectangle(0, 1, 1, 3))),
                           block("plate", rectangle(1, 1, 2, 2))});
    scene.joints = {bonded_joint("glue", 1e5, 1e5)};
    scene.contacts.default_joint = "glue";
    scene.blocks[2].held = {false, true, true};
    scene.blocks[2].driven.velocity_x = TimeTable::constant(0.25);
    const Scene built = build(scene);
    REQUIRE(built.model.faces.size() == 2);
    for (const JointFace& face : built.model.faces) CHECK(face.part_b == 2);
    REQUIRE(built.model.driven.size() == 1);
    CHECK(built.model.driven[0].x);
    CHECK_FALSE(built.model.driven[0].y);
    CHECK(built.state.motion.velocity[2] == Vec2(0.25, 0.0));
    CHECK(built.report.faces_per_joint[0] == 3);
}

TEST_CASE("a held axis has no inverse mass and starts without speed along it") {
    BlockSpec sled = block("sled", rectangle(0, 0, 1, 1));
    sled.held = {false, true, true};
    sled.velocity = {3.0, 4.0};
    sled.spin = 5.0;
    const Scene scene = build(with({sled}));
    CHECK(scene.model.blocks.inv_mass[0].x() == Approx(1.0 / 2500.0));
    CHECK(scene.model.blocks.inv_mass[0].y() == 0.0);
    CHECK(scene.model.blocks.inv_inertia[0] == 0.0);
    CHECK(scene.state.motion.velocity[0] == Vec2(3.0, 0.0));
    CHECK(scene.state.motion.spin[0] == 0.0);
}

TEST_CASE("a named pair of blocks goes before materials, and those before the default") {
    Scenario scene = with({block("a", rectangle(0, 0, 1, 1)), block("b", rectangle(1, 0, 2, 1)),
                           block("c", rectangle(2, 0, 3, 1)), block("d", rectangle(3, 0, 4, 1))});
    scene.materials.push_back({"steel", 7800.0});
    scene.blocks[2].material = scene.blocks[3].material = "steel";
    scene.joints = {joint("plain"), joint("rough"), joint("smooth"), joint("special")};
    scene.contacts.materials = {{"rock", "steel", "smooth"}, {"steel", "steel", "rough"}};
    scene.contacts.blocks = {{"d", "c", "special"}};
    const Model m = build(scene).model;
    CHECK(m.joints[m.joint_between(0, 1)].name == "plain");
    CHECK(m.joints[m.joint_between(1, 2)].name == "smooth");
    CHECK(m.joints[m.joint_between(2, 1)].name == "smooth");
    CHECK(m.joints[m.joint_between(2, 3)].name == "special");
    CHECK(m.joints[m.joint_between(3, 2)].name == "special");
    CHECK(m.blocks.mass[2] == Approx(7800.0));
}

TEST_CASE("repeated blocks are named together by the name before the bracket") {
    Scenario scene = with(brick_wall(2, 2));
    scene.blocks.push_back(held(block("base", rectangle(-1, -1, 6, 0))));
    scene.joints.push_back(joint("bed", 40.0));
    scene.contacts.blocks = {{"brick", "base", "bed"}};
    const Model m = build(scene).model;
    CHECK(m.joints[m.joint_between(0, 4)].name == "bed");
    CHECK(m.joints[m.joint_between(3, 4)].name == "bed");
    CHECK(m.joints[m.joint_between(0, 1)].name == "plain");
    CHECK(held_names(m) == std::vector<std::string>{"base"});
}

TEST_CASE("a joint keeps its strength unless residual values are given") {
    JointSpec spec = bonded_joint("j", 2e5, 1e5);
    CHECK_FALSE(make_joint(spec).weakens);
    CHECK(make_joint(spec).cohesion_residual == 2e5);
    spec.residual = ResidualSpec{radians(25.0), 1e4};
    const Joint j = make_joint(spec);
    CHECK(j.weakens);
    CHECK(j.tan_friction == Approx(std::tan(std::numbers::pi / 6.0)));
    CHECK(j.tan_friction_residual == Approx(0.46630765815));
}

TEST_CASE("overlapping blocks are a fault that says which, where and how deep") {
    Scenario scene = with({block("lower", rectangle(0, 0, 4, 1)), block("upper", rectangle(1, 0.75, 3, 2)),
                           block("beside", rectangle(3, 1, 4, 2))});
    scene.origin = {100.0, 0.0};
    const std::string report = report_of(scene);
    CHECK(report.find("`upper` overlaps block `lower` by 0.25 m at (102, 0.875)") != std::string::npos);
    CHECK(report.find("beside") == std::string::npos);

    scene.blocks[1].outline = rectangle(1, 1.0 - 1e-10, 3, 2);  // within the tolerance: 4e-9
    CHECK(report_of(scene).empty());
    scene.blocks[1].outline = rectangle(1, 1.0 - 1e-7, 3, 2);
    CHECK(report_of(scene).find("by 1e-07 m") != std::string::npos);
}

TEST_CASE("a block inside another and one across a concave one are found as overlaps") {
    const Polygon c{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {3, 2}, {3, 3}, {0, 3}};
    CHECK(report_of(with({block("c", c), block("in_the_mouth", rectangle(1, 1, 3, 2))})).empty());
    CHECK(report_of(with({block("c", c), block("bar", rectangle(2, -1, 2.5, 5))})).find("bar") != std::string::npos);
    CHECK(report_of(with({block("big", rectangle(0, 0, 9, 9)), block("small", rectangle(4, 4, 5, 5))})).find("small") !=
          std::string::npos);
}

TEST_CASE("every fault of a scene stands in one report") {
    Scenario scene = with({block("flat", {{0, 0}, {1, 0}, {2, 0}}), block("bow", {{0, 0}, {1, 1}, {1, 0}, {0, 1}}),
                           block("clockwise", {{0, 0}, {0, 1}, {1, 1}, {1, 0}}), block("ghost", rectangle(5, 5, 6, 6))});
    scene.blocks[3].material = "cheese";
    scene.blocks[3].where = {"wall.yaml", 17};
    const std::string report = report_of(scene);
    CHECK(report.find("blocks.flat: the outline encloses no area") != std::string::npos);
    CHECK(report.find("blocks.bow: edges") != std::string::npos);
    CHECK(report.find("blocks.clockwise: the corners must go around counter-clockwise") != std::string::npos);
    CHECK(report.find("wall.yaml:17 blocks.ghost.material: there is no material named `cheese`") != std::string::npos);
    CHECK(report_of(empty()).find("nothing to simulate") != std::string::npos);
}

TEST_CASE("names that fit nothing are faults") {
    Scenario scene = with({block("a", rectangle(0, 0, 1, 1)), block("b", rectangle(1, 0, 2, 1))});
    scene.contacts.materials = {{"rock", "chalk", "plain"}};
    scene.contacts.blocks = {{"a", "z", "sticky"}};
    const std::string report = report_of(scene);
    CHECK(report.find("`chalk`") != std::string::npos);
    CHECK(report.find("`z`") != std::string::npos);
    CHECK(report.find("`sticky`") != std::string::npos);
    scene = with({block("a", rectangle(0, 0, 1, 1))});
    scene.loads.resize(1);
    scene.loads[0].block.block = "missing";
    CHECK(report_of(scene).find("no block is named `missing`") != std::string::npos);
}

TEST_CASE("a wall far from the origin is the same wall") {
    const Vec2 away(4.5e5, 6.5e6);
    std::vector<BlockSpec> near = brick_wall(4, 4), far = near;
    for (BlockSpec& brick : near) brick.outline = turned(brick.outline, 0.0);
    for (BlockSpec& brick : far) brick.outline = shifted(brick.outline, away);
    Scenario here = with(near), there = with(far);
    here.joints = there.joints = {bonded_joint("mortar", 1e5, 1e5)};
    here.contacts.default_joint = there.contacts.default_joint = "mortar";
    const Model a = build(here).model, b = build(there).model;
    REQUIRE(a.corners.size() == b.corners.size());
    REQUIRE(a.faces.size() == b.faces.size());
    for (int k = 0; k < a.corners.size(); ++k) CHECK((a.corners.arm[k] - b.corners.arm[k]).norm() < 1e-9);
    for (std::size_t i = 0; i < a.faces.size(); ++i) {
        CHECK(a.faces[i].edge_a == b.faces[i].edge_a);
        CHECK(a.faces[i].s0 == Approx(b.faces[i].s0).margin(1e-9));
        CHECK(a.faces[i].s1 == Approx(b.faces[i].s1).margin(1e-9));
    }
    for (BlockId i = 0; i < a.blocks.size(); ++i) CHECK(a.blocks.inertia[i] == Approx(b.blocks.inertia[i]).epsilon(1e-9));
}

TEST_CASE("a rotated block of odd coordinates far away still touches its neighbour") {
    // 0.1 and 0.7 are not exact in binary: at 6.5e6 m the two copies of a corner agree only because they are the same
    // number.
    const Vec2 away(4.5e5, 6.5e6);
    Scenario scene = with({block("a", shifted(turned(rectangle(0.1, 0.1, 0.7, 0.7), 20), away)),
                           block("b", shifted(turned(rectangle(0.7, 0.1, 1.3, 0.7), 20), away))});
    CHECK(build(scene).report.faces_per_joint[0] == 1);
}

TEST_CASE("rock is held where it has an edge on an extreme side of the outline") {
    // Grid of 4 x 3 unit blocks; a step at the upper right, so that only the lower two rows reach the right side.
    Scenario scene = rock({{0, 0}, {4, 0}, {4, 2}, {3, 2}, {3, 3}, {0, 3}}, {joint_set(0, 1), joint_set(90, 1)});
    const auto count = [&](auto&& property) {
        const Model m = build(scene).model;
        int n = 0;
        for (BlockId b = 0; b < m.blocks.size(); ++b) n += property(m, b);
        return n;
    };
    const auto is_held = [](const Model& m, BlockId b) { return m.blocks.held(b); };
    scene.rock->held.left = SideSupport::held;
    CHECK(count(is_held) == 3);
    scene.rock->held.right = SideSupport::held;
    CHECK(count(is_held) == 5);
    scene.rock->held.top = SideSupport::held;
    CHECK(count(is_held) == 7);  // two more in the upper row; the block below the step has no edge on the extreme top
    scene.rock->held = {};
    scene.rock->held.bottom = SideSupport::roller;
    CHECK(count(is_held) == 0);
    CHECK(count([](const Model& m, BlockId b) {
              return m.blocks.inv_mass[b].x() > 0.0 && m.blocks.inv_mass[b].y() == 0.0 && m.blocks.inv_inertia[b] == 0.0;
          }) == 4);
    scene.rock->held.left = SideSupport::roller;  // the corner block is on both
    CHECK(count(is_held) == 1);
}

TEST_CASE("rock is held when it reaches beyond a line, not when it ends on it") {
    Scenario scene = rock(rectangle(0, 0, 4, 3), {joint_set(0, 1), joint_set(90, 1)});
    const auto held_blocks = [&] {
        const Model m = build(scene).model;
        int n = 0;
        for (BlockId b = 0; b < m.blocks.size(); ++b) n += m.blocks.held(b);
        return n;
    };
    scene.rock->held.below = 1.0;
    CHECK(held_blocks() == 4);
    scene.rock->held.below = 1.0 + 1e-6;
    CHECK(held_blocks() == 8);
    scene.rock->held.above = 2.5;
    CHECK(held_blocks() == 12);
    scene.rock->held = {};
    scene.rock->held.inside = {rectangle(0.4, 0.4, 1.6, 0.6)};
    CHECK(held_blocks() == 2);
}

TEST_CASE("a rule of `held` that finds no block is a fault that says what it looked for, in the coordinates of the user") {
    // A triangle on its tip: nothing but a corner lies at its lowest point.
    Scenario scene = rock({{0, 0}, {4, 4}, {-4, 4}}, {});
    scene.origin = {450000, 6500000};
    scene.rock->held.bottom = SideSupport::held;
    scene.rock->held.below = -1.0;
    scene.rock->held.above = 5.0;
    scene.rock->held.inside = {rectangle(-1, 2, 1, 3), rectangle(7, 7, 8, 8)};
    std::string message;
    try {
        build(scene);
    } catch (const InputError& error) {
        CHECK(error.faults().size() == 4);
        message = error.what();
    }
    CHECK_THAT(message, Catch::Contains("rock.held.bottom: holds nothing") && Catch::Contains("y = 6500000,"));
    CHECK_THAT(message, Catch::Contains("no block reaches below y = 6499999;"));
    CHECK_THAT(message, Catch::Contains("no block reaches above y = 6500005; the rock ends at y = 6500004"));
    CHECK_THAT(message, Catch::Contains("rock.held.inside[1]"));
}

TEST_CASE("faces along a joint set with a joint of its own have that joint, unless a pair of blocks is named") {
    Scenario scene = rock(rectangle(0, 0, 4, 3), {joint_set(0, 1, "bedding"), joint_set(90, 1)});
    scene.joints = {joint("plain"), joint("bedding"), joint("special")};
    Scene built = build(scene);
    REQUIRE(built.model.blocks.size() == 12);
    CHECK(built.report.faces_per_joint == std::vector<int>{3 * 3, 4 * 2, 0});
    const Model& m = built.model;
    for (PartId a = 0; a < m.parts.size(); ++a)
        for (PartId b = a + 1; b < m.parts.size(); ++b) {
            const Vec2 apart = m.blocks.start[b] - m.blocks.start[a];
            if (std::abs(apart.norm() - 1.0) > 1e-9) continue;
            CHECK(m.joints[m.joint_between(a, b)].name == (std::abs(apart.y()) > 0.5 ? "bedding" : "plain"));
        }
}

TEST_CASE("a named pair goes before the joint set that cut it, and that before materials") {
    Scenario scene = rock(rectangle(0, 0, 2, 2), {joint_set(0, 1, "bedding")});
    scene.joints = {joint("plain"), joint("bedding"), joint("special"), joint("soft")};
    scene.materials.push_back({"clay", 2000.0});
    scene.rock->regions = {{"top", rectangle(0, 1, 2, 2), "clay"}};
    scene.contacts.materials = {{"rock", "clay", "soft"}};
    Model m = build(scene).model;
    REQUIRE(m.blocks.size() == 2);
    CHECK(m.joints[m.joint_between(0, 1)].name == "bedding");
    CHECK(m.blocks.mass[0] + m.blocks.mass[1] == Approx(2 * (2500.0 + 2000.0)));

    scene.blocks = {block("beam", rectangle(0, 2, 2, 3))};
    scene.contacts.blocks = {{"top", "beam", "special"}};
    m = build(scene).model;
    const BlockId top = m.blocks.region[0] == 0 ? 0 : 1;
    CHECK(m.region_names == std::vector<std::string>{"top"});
    CHECK(m.joints[m.joint_between(top, 2)].name == "special");
    CHECK(m.joints[m.joint_between(1 - top, 2)].name == "plain");
    CHECK(m.joints[m.joint_between(0, 1)].name == "bedding");
}

TEST_CASE("blocks of rock touch each other along inclined joints exactly once") {
    // Sum over faces of twice the length + the outline = sum of the perimeters of all blocks.
    Scenario scene = rock(rectangle(0, 0, 20, 12), {joint_set(-35, 1.3), joint_set(70, 1.7), joint_set(12, 2.9)});
    scene.joints = {bonded_joint("plain", 1e5, 0.0)};
    const Scene built = build(scene);
    double faces = 0.0, edges = 0.0;
    for (const JointFace& face : built.model.faces) faces += face.s1 - face.s0;
    for (int k = 0; k < built.model.corners.size(); ++k)
        if (!built.model.corners.internal[k]) edges += built.model.corners.length[k];
    CHECK(built.model.blocks.size() > 100);
    CHECK(2.0 * faces + 64.0 == Approx(edges).epsilon(1e-12));
}

TEST_CASE("a single block may stand on cut rock but not in it") {
    Scenario scene = rock({{0, 0}, {10, 0}, {10, 4}, {0, 2}}, {joint_set(40, 1.5)});
    const double slope = std::atan2(2.0, 10.0);
    const Vec2 along(std::cos(slope), std::sin(slope)), up = perp(along), foot = Vec2(0, 2) + 3.0 * along;
    scene.blocks = {block("house", {foot, foot + 2.0 * along, foot + 2.0 * along + up, foot + up})};
    const Scene built = build(scene);
    const BlockId house = built.model.blocks.size() - 1;
    scene.joints = {bonded_joint("plain", 1e5, 0.0)};
    double length = 0.0;
    for (const JointFace& face : build(scene).model.faces)
        if (built.model.parts.block[face.part_b] == house) length += face.s1 - face.s0;
    CHECK(length == Approx(2.0));
    scene.blocks[0].outline = shifted(scene.blocks[0].outline, Vec2(0, -0.1));
    CHECK(report_of(scene).find("block `house` overlaps the block of rock at") != std::string::npos);
}

TEST_CASE("warnings name what was hardly meant") {
    Scenario scene =
        with({block("a", rectangle(0, 0, 1, 1)), block("b", rectangle(1, 0, 2, 1)), block("lonely", rectangle(8, 8, 9, 9))});
    scene.joints.push_back(joint("forgotten"));
    scene.joints.push_back(bonded_joint("glue", 1e5, 1e5));
    scene.contacts.blocks = {{"a", "lonely", "glue"}};
    const std::vector<std::string> told = build(scene).report.warnings;
    REQUIRE(told.size() == 4);
    CHECK(told[0] == "joint `forgotten` is never used");
    CHECK(told[1].starts_with("joint `glue` has strength to bond blocks"));
    CHECK(told[2].starts_with("no block is held or driven"));
    CHECK(told[3].starts_with("1 free block(s) share no edge"));
    CHECK(build(with({held(block("base", rectangle(0, 0, 1, 1))), block("top", rectangle(0, 1, 1, 2))}))
              .report.warnings.empty());
}

TEST_CASE("corners of concave blocks and joints under initial stress cannot be rounded; short edges are told") {
    const Polygon bracket{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}};
    Scenario scene = with({held(block("base", rectangle(0, -1, 3, 0))), block("bracket", bracket)});
    scene.run.rounding_length = 0.01;
    CHECK(report_of(scene).find("1 are concave, the first of them block `bracket`") != std::string::npos);
    scene.blocks[1].outline = rectangle(0, 0, 1, 0.015);
    REQUIRE(report_of(scene).empty());
    const std::vector<std::string> told = build(scene).report.warnings;
    REQUIRE(told.size() == 1);
    CHECK(told[0].find("the least from 0.0075 m") != std::string::npos);
    scene.initial_stress.emplace();
    scene.initial_stress->joints = {{"plain", 1e5, 0.0}};
    CHECK(report_of(scene).find("initial_stress: is not available with run.rounding_length") != std::string::npos);
}
