#include "rigid/touches.hpp"

#include "contact/contacts.hpp"
#include "core/parallel.hpp"
#include "rigid/touch_arms.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace talus::rigid {
namespace {

constexpr int few = 1000;  // contacts: one thread has looked at them by the time that a second one has woken

// Shares of the smaller thickness of two parts. Touching: what the cut of a rock leaves between neighbours by rounding is
// 1e-12 of it. Narrow: two corners that overlap by less along the joint pass each other; larger, and blocks that slide over
// a row of others catch on steps of that height, smaller, and they catch on what the solver leaves of overlap.
// Came in: of an overlap above this it counts through which face the two came together. Resting and sliding blocks stay
// below a hundredth of it; ten times as much, and steps that are a thousandth as high as a block are run over.
constexpr double as_far = 1e-6;  // of a speed: who is faster by less comes no further
constexpr double touching = 1e-9, narrow = 1e-5, came_in = 1e-4;

// A block of width w and radius of inertia r that rocks brings its corner down with 1.5 (w2 / 12 r2) of free fall, its
// neighbours may bring it down faster. From blocks that are less than two and a half times as high as wide this is free
// fall, and they are taken so: half of it and collapsing arches, whose impacts are in the order of free fall, follow these
// one by one.
constexpr double rocking_fall = 8.0 / 12.0;

// Of the way of free fall: no end is looked at more closely.
constexpr double least_near = 1e-3;

Vec2 velocity_at(const Velocity& v, const Vec2& arm) { return Vec2(v.x, v.y) + v.spin * perp(arm); }

/// m/s, of the fastest point of a block at `position` (m); `rebounds` as in Touches::fastest.
double fastest_point(const Model& model, const Vec2& position, const Bodies& bodies, BlockId b, bool rebounds) {
    const int q = bodies.body_of[b];
    const Velocity& v = bodies.velocity[q];
    const double arm = (position - bodies.position[q]).norm() + model.blocks.radius[b];
    const Softness& soft = bodies.softness[q];
    if (!rebounds || soft.spin == 0.0) return std::hypot(v.x, v.y) + std::abs(v.spin) * arm;
    // With the radius of inertia r the energy is m (v2 + r2 w2) / 2, and v + w arm <= sqrt(v2 + r2 w2) sqrt(1 + arm2 / r2).
    const double r2 = std::max(soft.x, soft.y) / soft.spin;
    return std::sqrt((v.x * v.x + v.y * v.y + r2 * v.spin * v.spin) * (1.0 + arm * arm / r2));
}

double thinner(const Model& model, const Contact& c) {
    return std::min(model.parts.thickness[c.part_a], model.parts.thickness[c.part_b]);
}

/// N, of a bonded face: it has slipped, or nothing of it is left.
double cohesion(const Model& model, const State& state, const Contact& known, const Manifold& m) {
    const Joint& joint = model.joints[known.joint];
    const JointFace& face = model.faces[known.face];
    const double bonded = std::min(intact_length(model, state, known), m.length);
    const double rest = std::max(0.0, std::min(face.s1 - face.s0, m.length) - bonded);
    return joint.cohesion * bonded + (joint.weakens ? joint.cohesion_residual * rest : 0.0);
}

/// Impulses that acted in the step before; a moment about the middle tells how they were shared by the ends.
void take_over(const Contact& known, const Manifold& m, double dt, Touch& c) {
    if (known.normal_force <= 0.0 || known.struck || known.normal.dot(m.normal) <= 0.99) return;
    if (m.count == 2) {
        // One end alone: the stretch has hardly the length any more with which the moment was taken.
        const double couple = known.moment / m.length, rounding = 1e-3 * known.normal_force;
        const double first = 0.5 * known.normal_force - couple, second = 0.5 * known.normal_force + couple;
        c.p[0] = first > rounding ? first * dt : 0.0;
        c.p[1] = second > rounding ? second * dt : 0.0;
    } else {
        c.p[0] = known.normal_force * dt;
    }
    const double bound = c.friction * (c.p[0] + c.p[1]) + c.cohesion;
    c.p[2] = std::clamp(known.shear_force * dt, -bound, bound);
}

}  // namespace

double Touches::fastest(const Model& model, const Motion& motion, const Bodies& bodies, bool rebounds) {
    double fastest = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        fastest = std::max(fastest, fastest_point(model, motion.position[b], bodies, b, rebounds));
    return fastest;
}

bool Touches::outrun(const Model& model, const Placed& placed, const Bodies& bodies) {
    bool any = false;
    for (BlockId b = 0; b < model.blocks.size() && !any; ++b)
        any = fastest_point(model, placed.block[b].position, bodies, b, false) > (1.0 + as_far) * speed_[b];
    if (!any) return false;
    seen_ = speed_;
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        seen_[b] = std::max(seen_[b], fastest_point(model, placed.block[b].position, bodies, b, true));
    return true;
}

double Touches::fastest_seen() const { return seen_.empty() ? 0.0 : *std::ranges::max_element(seen_); }

Manifold Touches::look_at(const Model& model, const Placed& placed, const Contact& c, const Bodies& bodies,
                          std::span<const Velocity> before, double dt, int& hint) const {
    const BlockId a = model.parts.block[c.part_a], b = model.parts.block[c.part_b];
    if (bodies.body_of[a] == bodies.body_of[b]) return {};
    const PlacedPart part_a(model, placed, c.part_a), part_b(model, placed, c.part_b);
    const Vec2 to_b = placed.block[b].position - placed.block[a].position;
    const double thickness = thinner(model, c), reach = 0.5 * dt * (speed_[a] + speed_[b]) + touching * thickness;
    const Manifold now = find_manifold(part_a, part_b, to_b, reach, narrow * thickness, hint);
    if (now.distance >= -came_in * thickness) return now;
    const auto of = [&](BlockId block) {
        const Velocity& v = before[bodies.body_of[block]];
        const Vec2 u = velocity_at(v, placed.block[block].position - bodies.position[bodies.body_of[block]]);
        return Velocity{u.x(), u.y(), v.spin};
    };
    Manifold entered = find_manifold(part_a, part_b, to_b, reach, narrow * thickness, {of(a), of(b), 0.5 * dt});
    if (entered.count == 0) return now;
    entered.distance = now.distance;
    return entered;
}

void Touches::find(const Model& model, const Placed& placed, const State& state, const Bodies& bodies,
                   std::span<const Velocity> before, bool rebounds, double fall, double dt) {
    const int n = static_cast<int>(state.contacts.list.size()), nb = model.blocks.size();
    if (static_cast<int>(hint_.size()) != n) hint_.assign(n, -1);
    found_.resize(n);
    speed_.resize(nb);
    for_all(nb, few, [&](int b) {
        const double known = fastest_point(model, placed.block[b].position, bodies, b, rebounds);
        speed_[b] = seen_.empty() ? known : std::max(known, seen_[b]);
    });
    for_all(n, few,
            [&](int i) { found_[i] = look_at(model, placed, state.contacts.list[i], bodies, before, dt, hint_[i]); });

    touches_.clear(), manifold_.clear(), slot_.clear(), rebound_.clear(), from_a_.clear(), end_.clear();
    deepest_ = {};
    for (int i = 0; i < n; ++i) {
        const Manifold& m = found_[i];
        const Contact& known = state.contacts.list[i];
        if (m.distance < 0.0) {
            const double share = -m.distance / thinner(model, known);
            if (share > deepest_.share) deepest_ = {i, -m.distance, share};
        }
        if (m.count == 0) continue;
        const Joint& joint = model.joints[known.joint];
        const BlockId block_a = model.parts.block[known.part_a];
        Touch c{};
        c.a = bodies.body_of[block_a];
        c.b = bodies.body_of[model.parts.block[known.part_b]];
        const Softness &soft_a = bodies.softness[c.a], &soft_b = bodies.softness[c.b];
        if (soft_a.x + soft_a.y + soft_a.spin + soft_b.x + soft_b.y + soft_b.spin == 0.0) continue;
        c.ends = m.count;
        from_a_.push_back(placed.block[block_a].position - bodies.position[c.a]);
        set_arms(m, from_a_.back(), bodies, {}, c);
        c.sticks = -0.5 * dt * bend(m, bodies, before, from_a_.back(), c, nearest(m)).y();
        c.friction = known.slipped && joint.weakens ? joint.tan_friction_residual : joint.tan_friction;
        if (fits_bond(model, known)) c.cohesion = cohesion(model, state, known, m) * dt;
        take_over(known, m, dt, c);
        rebound_.push_back(joint.restitution);
        touches_.push_back(c);
        manifold_.push_back(m);
        slot_.push_back(i);
    }
    carried_ = bodies.velocity;
    for (const Touch& c : touches_) apply(c, c.p, bodies.softness, carried_);
    find_turns(state, before);
    judge_ends(model, state, bodies, before, fall, dt);
    find_impacts(bodies, before, dt);
}

// What slides at the start of the step, and would go the other way at its end if friction went on as before, comes to rest
// at the share f of it. Friction opposes it in full until then; only from then on it may have any other size. Else what
// slides up a slope would stay until the next step where it comes to rest, and not turn back at once: an error of first
// order.
void Touches::find_turns(const State& state, std::span<const Velocity> before) {
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        Touch& c = touches_[i];
        if (!state.contacts.list[slot_[i]].sliding) continue;
        const double slides = tangent_velocity(c, before) + c.sticks, end = tangent_velocity(c, carried_) - c.sticks;
        if (slides * c.p[2] >= 0.0 || slides * end >= 0.0) continue;
        (slides > 0.0 ? c.along : c.against) = 1.0 - 2.0 * slides / (slides - end);
    }
}

double Touches::share_of_fall(const Model& model, const State& state, const Bodies& bodies, std::size_t touch) const {
    if (rebound_[touch] > 0.0) return 1.0;
    const Contact& known = state.contacts.list[slot_[touch]];
    const Touch& c = touches_[touch];
    double share = 1.0;
    for (const auto& [body, part] : {std::pair(c.a, known.part_a), std::pair(c.b, known.part_b)}) {
        const Softness& soft = bodies.softness[body];
        const double width = model.parts.thickness[part];
        share = std::min(share, soft.spin > 0.0 && soft.x > 0.0 ? rocking_fall * width * width * soft.spin / soft.x : 1.0);
    }
    return share;
}

// m, how far either body falls along the normal at an end within the step: a wall beside what falls is not what it falls on,
// and would stop it short of a gap that it never closes.
double falls_towards(const Touch& c, const Bodies& bodies, std::span<const Velocity> before, int end, double dt) {
    const auto gained = [&](int q, const double arm[3]) {
        const Velocity &v = bodies.velocity[q], &v0 = before[q];
        return std::abs(c.nx * (v.x - v0.x) + c.ny * (v.y - v0.y) + arm[end] * (v.spin - v0.spin));
    };
    return 0.5 * dt * std::max(gained(c.a, c.arm_a), gained(c.b, c.arm_b));
}

// What carried a body in the step before most likely carries it in this one: a slender block that rocks about one corner
// brings the other down with a hundredth of the acceleration of free fall, and slowly. Seen as if nothing carried it, it
// would land too early, and its impact would count as none.
void Touches::judge_ends(const Model& model, const State& state, const Bodies& bodies, std::span<const Velocity> before,
                         double fall, double dt) {
    near_.assign(2 * touches_.size(), fall);
    slow_.assign(touches_.size(), 1.0);
    end_.assign(2 * touches_.size(), End::meets);
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        Touch& c = touches_[i];
        slow_[i] = share_of_fall(model, state, bodies, i);
        for (int end = 0; end < c.ends; ++end) {
            const double u = normal_velocity(c, ahead_of_contacts(i, bodies), end), gap = manifold_[i].gap[end];
            double& near = near_[2 * i + end];
            if (slow_[i] < 1.0)
                near = std::clamp(0.5 * dt * std::abs(u - normal_velocity(c, before, end)), slow_[i] * fall, fall);
            else if (c.p[end] == 0.0)
                near = std::clamp(falls_towards(c, bodies, before, end, dt), least_near * fall, fall);
            if (gap + 0.5 * dt * u <= 0.0 || gap <= near) {
                c.least[end] = -0.5 * dt * bend(manifold_[i], bodies, before, from_a_[i], c, end).x();
            } else {
                c.least[end] = -2.0 * gap / dt;
                end_[2 * i + end] = End::comes_near;
            }
        }
    }
}

}  // namespace talus::rigid
