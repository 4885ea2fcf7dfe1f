// Small models and states made by hand, for tests that need no scenario file.
#pragma once

#include "core/random.hpp"
#include "model/model.hpp"
#include "model/state.hpp"

#include <cmath>
#include <utility>
#include <vector>

namespace talus::test {

/// Blocks given by their convex parts, density 2000 kg/m3, one material, one joint; none is held.
inline Model blocks_of_parts(const std::vector<std::vector<Polygon>>& blocks) {
    Model m;
    m.material_names = {"granite"};
    Joint rough;
    rough.kn = 1e9, rough.ks = 5e8, rough.tan_friction = rough.tan_friction_residual = 0.5, rough.name = "rough";
    m.joints.push_back(rough);
    m.joint_of_materials = {0};
    m.blocks.first_part = {0};
    m.parts.first_corner = {0};
    for (const auto& parts : blocks) {
        double area = 0.0, second = 0.0;  // second moment of area about the origin
        Vec2 first = Vec2::Zero();
        for (const Polygon& part : parts)
            for (std::size_t i = 0; i < part.size(); ++i) {
                const Vec2 &p = part[i], &q = part[(i + 1) % part.size()];
                const double w = cross(p, q) / 2.0;
                area += w;
                first += w / 3.0 * (p + q);
                second += w / 6.0 * (p.dot(p) + p.dot(q) + q.dot(q));
            }
        const Vec2 centroid = first / area;
        const double mass = 2000.0 * area, inertia = 2000.0 * (second - area * centroid.squaredNorm());
        const BlockId b = m.blocks.size();
        for (const Polygon& part : parts) {
            for (std::size_t i = 0; i < part.size(); ++i) {
                const Vec2 arm = part[i] - centroid, edge = part[(i + 1) % part.size()] - part[i];
                const Vec2 normal = -perp(edge) / edge.norm();
                m.corners.arm.push_back(arm);
                m.corners.normal.push_back(normal);
                m.corners.offset.push_back(normal.dot(arm));
                m.corners.length.push_back(edge.norm());
                m.corners.internal.push_back(0);
            }
            m.parts.block.push_back(b);
            m.parts.first_corner.push_back(m.corners.size());
            m.parts.thickness.push_back(1.0);
        }
        m.blocks.mass.push_back(mass);
        m.blocks.inertia.push_back(inertia);
        m.blocks.area.push_back(area);
        m.blocks.inv_mass.emplace_back(1.0 / mass, 1.0 / mass);
        m.blocks.inv_inertia.push_back(1.0 / inertia);
        m.blocks.start.push_back(centroid);
        m.blocks.material.push_back(0);
        m.blocks.name.emplace_back();
        m.blocks.region.push_back(-1);
        m.blocks.first_part.push_back(m.parts.size());
    }
    return m;
}

inline Polygon rectangle(double x, double y, double width, double height) {
    return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

/// nx * ny unit squares edge to edge; the lowest row is held.
inline Model wall(int nx, int ny) {
    std::vector<std::vector<Polygon>> blocks;
    for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i) blocks.push_back({rectangle(i, j, 1.0, 1.0)});
    Model m = blocks_of_parts(blocks);
    for (BlockId b = 0; b < nx; ++b) m.blocks.inv_mass[b] = Vec2::Zero(), m.blocks.inv_inertia[b] = 0.0;
    return m;
}

/// An L of two convex parts (block 0), and a square on its foot (block 1).
inline Model l_and_square() {
    return blocks_of_parts({{rectangle(0, 0, 3, 1), rectangle(0, 1, 1, 2)}, {rectangle(1, 1, 1, 1)}});
}

inline State at_rest(const Model& m) {
    const auto n = static_cast<std::size_t>(m.blocks.size());
    State s;
    s.motion = {m.blocks.start, std::vector<double>(n, 0.0), std::vector<Vec2>(n, Vec2::Zero()),
                std::vector<double>(n, 0.0)};
    s.load.resize(n);
    s.removed.assign(n, 0);
    s.start_position = m.blocks.start;
    s.start_angle.assign(n, 0.0);
    s.contacts.broken.assign(static_cast<std::size_t>(m.cells()), 0);
    return s;
}

/// Every member has a value of its own, of any size and sign; contacts between random parts, every fourth not alive.
inline State random_state(const Model& m, std::uint64_t seed, int contacts) {
    Random random(seed);
    const auto number = [&] { return random.normal() * std::pow(10.0, 20.0 * random.uniform() - 10.0); };
    const auto vector = [&] { return Vec2(number(), number()); };
    const auto force = [&] { return Force{vector(), number()}; };
    const auto flag = [&] { return static_cast<std::uint8_t>(random.bits() % 2); };
    const auto below = [&](int n) { return static_cast<int>(random.bits() % static_cast<std::uint64_t>(n)); };
    State s = at_rest(m);
    s.time = number(), s.stage_time = number();
    s.step = static_cast<std::int64_t>(random.bits() >> 2), s.total_steps = static_cast<std::int64_t>(random.bits() >> 2);
    s.stage = below(9), s.step_halvings = below(9), s.calm_checks = below(3), s.stage_step = number();
    for (BlockId b = 0; b < m.blocks.size(); ++b) {
        s.motion.position[b] = vector(), s.motion.velocity[b] = vector(), s.start_position[b] = vector();
        s.motion.angle[b] = number(), s.motion.spin[b] = number(), s.start_angle[b] = number();
        s.load[b] = force(), s.removed[b] = flag(), s.release.push_back(force());
        s.damping.push_back(force());
    }
    for (int i = 0; i < contacts; ++i) {
        Contact c{};
        c.part_a = below(m.parts.size()), c.part_b = below(m.parts.size()),
        c.joint = below(static_cast<int>(m.joints.size()));
        c.face = below(static_cast<int>(m.faces.size()) + 1) - 1;
        c.edge_a = below(m.corners.size() + 1) - 1, c.edge_b = below(m.corners.size() + 1) - 1;
        c.touching = flag(), c.slipped = flag(), c.sliding = flag(), c.alive = i % 4 != 3;
        c.length = std::abs(number()), c.overlap = number(), c.normal_force = number(), c.shear_force = number();
        c.strength = number(), c.shear_energy = number(), c.moment = number(), c.slip = number(), c.slip_sum = number(),
        c.dilation = number(), c.point = vector(), c.normal = vector();
        s.contacts.list.push_back(c);
        s.contacts.reaction.push_back({vector(), number(), number()});
    }
    for (auto& cell : s.contacts.broken) cell = static_cast<std::uint8_t>(below(3));
    Statics& t = s.statics;
    t.held_back = s.release, t.load = s.damping, t.position = s.start_position, t.start = s.motion.position;
    t.angle = s.motion.angle, t.newton_ratios = s.motion.spin;
    t.load_share = number(), t.load_rate = number(), t.damping = number(), t.shift = number();
    t.load_lag = number(), t.pressed = number(), t.push = number();
    t.look_share = number(), t.look_ratio = number(), t.look_distance = number();
    t.window = below(9), t.suspicious = below(9), t.polish_at = below(99), t.patience = below(99), t.look_at = below(99);
    const auto evidence = [&] {
        return StaticEvidence{below(9), flag(),    below(9),  number(),  number(),
                              number(), below(99), below(99), below(99), below(99)};
    };
    t.earlier = {evidence(), evidence()}, t.now = evidence();
    s.unsettled = {{below(9), number()}, {below(9), number()}};
    Course& c = s.course;
    c.window = number(), c.window_begin = number(), c.next_look = number(), c.give = number(), c.mean_time = number();
    c.kinetic = number(), c.kinetic_last = number(), c.kinetic_before = number(), c.certain_at = number();
    c.looks = below(99), c.verdict = static_cast<Stability>(below(3));
    for (BlockId b = 0; b < m.blocks.size(); ++b) {
        c.sum.push_back(vector()), c.mean.push_back(vector()), c.velocity.push_back(vector()),
            c.velocity_begin.push_back(vector());
        c.turn_sum.push_back(number()), c.turn_mean.push_back(number());
        c.speed.push_back(number()), c.speed_before.push_back(number()), c.reach.push_back(number());
        for (auto* list : {&c.rested, &c.no_further, &c.fell}) list->push_back(static_cast<std::uint8_t>(below(256)));
        c.going.push_back(static_cast<std::uint8_t>(below(256))), c.set_out.push_back(static_cast<SetOut>(below(3)));
        c.mechanism.push_back(static_cast<Mechanism>(below(6)));
    }
    Ledger& l = s.ledger;
    for (double* e : {&l.total0, &l.kinetic0, &l.gravity, &l.loads, &l.contact, &l.local_damping, &l.driven, &l.friction,
                      &l.contact_damping, &l.released, &l.gained, &l.largest, &s.earlier_gain})
        *e = number();
    return s;
}

}  // namespace talus::test
