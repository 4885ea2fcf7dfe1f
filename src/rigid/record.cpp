#include "contact/contacts.hpp"
#include "contact/separation.hpp"
#include "rigid/touch_arms.hpp"

#include <algorithm>
#include <cmath>

namespace talus::rigid {
namespace {

/// m, of the end from the middle of the whole stretch, along the tangent.
double place(const Manifold& m, int end) {
    if (m.count == 2) return end == 0 ? -0.5 * m.length : 0.5 * m.length;
    return m.single_low ? -0.5 * m.length : 0.5 * m.length;
}

}  // namespace

void Touches::add_forces(const Model& model, const Placed& placed, const State& state, double dt,
                         std::span<Force> sum) const {
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        const Touch& c = touches_[i];
        const Manifold& m = manifold_[i];
        const Contact& known = state.contacts.list[slot_[i]];
        const BlockId a = model.parts.block[known.part_a], b = model.parts.block[known.part_b];
        const Vec2 to_b = placed.block[b].position - placed.block[a].position;
        for (int end = 0; end < m.count; ++end) {
            Vec2 force = c.p[end] / dt * m.normal;
            if (end == nearest(m)) force += c.p[2] / dt * perp(m.normal);
            sum[a].force -= force;
            sum[a].torque -= cross(m.point[end], force);
            sum[b].force += force;
            sum[b].torque += cross(m.point[end] - to_b, force);
        }
    }
}

void Touches::record(const Model& model, const Placed& placed, const Bodies& bodies, std::span<const Velocity> before,
                     std::span<const Velocity> after, std::span<const Velocity> displacement, double dt, double resolution,
                     State& state) const {
    std::vector<Contact>& list = state.contacts.list.edit();
    std::size_t next = 0;
    const int n = static_cast<int>(list.size());
    for (int i = 0; i < n; ++i) {
        Contact& c = list[i];
        const BlockId a = model.parts.block[c.part_a], b = model.parts.block[c.part_b];
        if (bodies.body_of[a] == bodies.body_of[b]) continue;  // a bond: see bonds.hpp
        const bool found = next < slot_.size() && slot_[next] == i;
        const Touch* t = found ? &touches_[next] : nullptr;
        const Manifold* m = found ? &manifold_[next] : nullptr;
        if (found) ++next;
        const double pressed = t ? t->p[0] + (t->ends == 2 ? t->p[1] : 0.0) : 0.0;
        if (!t || (pressed == 0.0 && t->p[2] == 0.0)) {
            const bool remembers = c.slipped || (c.face >= 0 && !fits_bond(model, c));
            state.contacts.reaction[i] = {};
            if (remembers && separation(PlacedPart(model, placed, c.part_a), PlacedPart(model, placed, c.part_b),
                                        placed.block[b].position.x() - placed.block[a].position.x(),
                                        placed.block[b].position.y() - placed.block[a].position.y())
                                     .distance <= memory_reach(model, c.part_a, c.part_b)) {
                c.touching = c.sliding = c.struck = 0;
                c.length = c.normal_force = c.shear_force = c.strength = c.moment = 0.0;
            } else {
                c = Contact{.part_a = c.part_a, .part_b = c.part_b, .joint = c.joint};
            }
            continue;
        }
        const double bound = t->friction * pressed + t->cohesion;
        const double u0 = tangent_velocity(*t, before), u1 = tangent_velocity(*t, after);
        c.touching = c.alive = 1;
        c.struck = moved_by_impact(bodies, t->a) || moved_by_impact(bodies, t->b);
        c.sliding = (t->slips || std::abs(t->p[2]) >= bound * (1.0 - 1e-9)) && std::abs(u1) > resolution;
        c.edge_a = m->count == 2 ? m->edge_a : -1;
        c.edge_b = m->count == 2 ? m->edge_b : -1;
        c.length = m->count == 2 ? m->length : 0.0;
        c.normal = m->normal;
        c.overlap = 0.0;
        for (int end = 0; end < t->ends; ++end) {  // at the end of the step
            const double moved = displacement.empty() ? 0.0 : normal_velocity(*t, displacement, end);
            c.overlap -= (m->gap[end] + 0.5 * dt * normal_velocity(*t, after, end) + moved) / t->ends;
        }
        c.normal_force = pressed / dt;
        c.shear_force = t->p[2] / dt;
        c.shear_energy = 0.0;
        c.strength = bound / dt;
        c.moment = (t->p[0] * place(*m, 0) + (m->count == 2 ? t->p[1] * place(*m, 1) : 0.0)) / dt;
        const double share = m->count == 2 && pressed > 0.0 ? t->p[1] / pressed : 0.0;
        const Vec2 arm = m->count == 2 ? Vec2(m->point[0] + share * (m->point[1] - m->point[0])) : m->point[0];
        c.point = placed.block[a].position + arm;
        if (c.sliding) {
            const double slid = 0.5 * dt * (u0 + u1);
            c.slip += std::abs(slid);
            c.slip_sum += slid;
            c.slipped = 1;
        }
        const Vec2 force = c.normal_force * m->normal + c.shear_force * perp(m->normal);
        const Vec2 from_b = c.point - placed.block[b].position;
        state.contacts.reaction[i] = {force, -cross(arm, force), cross(from_b, force)};
        state.ledger.friction -= 0.5 * (u0 + u1) * t->p[2];
        for (int end = 0; end < t->ends; ++end)
            state.ledger.contact_damping -=
                0.5 * t->p[end] * (normal_velocity(*t, before, end) + normal_velocity(*t, after, end));
    }
}

}  // namespace talus::rigid
