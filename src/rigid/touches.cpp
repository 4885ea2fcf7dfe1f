#include "rigid/touches.hpp"

#include "contact/contacts.hpp"
#include "contact/separation.hpp"
#include "core/parallel.hpp"
#include "core/turn.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace talus::rigid {
namespace {

constexpr int few = 1000;  // contacts: one thread has looked at them by the time that a second one has woken

// Shares of the smaller thickness of two parts. Touching: what the cut of a rock leaves between neighbours by rounding is
// 1e-12 of it. Narrow: two corners that overlap by less along the joint pass each other; larger, and blocks that slide over
// a row of others catch on steps of that height, smaller, and they catch on what the solver leaves of overlap.
// Came in: of an overlap above this it counts through which face the two came together. Resting and sliding blocks stay
// below a hundredth of it; ten times as much, and steps that are a thousandth as high as a block are run over.
constexpr double touching = 1e-9, narrow = 1e-5, came_in = 1e-4;

constexpr double none = 2.0;  // share of a step: no impact in it
// Of a step, from its middle: what hits at its very end must not be missed by rounding, or the next step finds it inside.
constexpr double at_the_latest = 0.5 * (1.0 + 1e-9);

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

double normal_velocity(const Touch& c, std::span<const Velocity> v, int end) {
    const Velocity &a = v[c.a], &b = v[c.b];
    return c.nx * (b.x - a.x) + c.ny * (b.y - a.y) + c.arm_b[end] * b.spin - c.arm_a[end] * a.spin;
}

double tangent_velocity(const Touch& c, std::span<const Velocity> v) {
    const Velocity &a = v[c.a], &b = v[c.b];
    return c.nx * (b.y - a.y) - c.ny * (b.x - a.x) + c.arm_b[2] * b.spin - c.arm_a[2] * a.spin;
}

/// m, of the end from the middle of the whole stretch, along the tangent.
double place(const Manifold& m, int end) {
    if (m.count == 2) return end == 0 ? -0.5 * m.length : 0.5 * m.length;
    return m.single_low ? -0.5 * m.length : 0.5 * m.length;
}

double thinner(const Model& model, const Contact& c) {
    return std::min(model.parts.thickness[c.part_a], model.parts.thickness[c.part_b]);
}

/// The end at which friction acts.
int nearest(const Manifold& m) { return m.count == 2 && m.gap[1] < m.gap[0] ? 1 : 0; }

struct Ahead {          // of the middle of the step, as both bodies moved before it
    double time = 0.0;  // s
    Velocity a{}, b{};
};

/// Directions and arms of a touch; `from_a`: of the centroid of its block a from that of the body (m).
void set_arms(const Manifold& m, const Vec2& from_a, const Bodies& bodies, const Ahead& ahead, Touch& c) {
    const Velocity& face = m.face_of_b ? ahead.b : ahead.a;
    const Turn turned = turn(ahead.time * face.spin);
    const Vec2 n = turned.c * m.normal + turned.s * perp(m.normal);
    c.nx = n.x(), c.ny = n.y();
    const Vec2 to_b = bodies.position[c.b] - bodies.position[c.a];
    const Vec2 apart = to_b + ahead.time * Vec2(ahead.b.x - ahead.a.x, ahead.b.y - ahead.a.y);
    for (int end = 0; end < m.count; ++end) {
        Vec2 arm = m.point[end] + from_a;  // from a
        if (ahead.time != 0.0) {           // the corner moves with its body, and comes onto the face
            const bool of_b = m.corner_of_b[end];
            const Turn own = turn(ahead.time * (of_b ? ahead.b.spin : ahead.a.spin));
            const Vec2 corner = arm + (of_b ? 0.5 : -0.5) * m.gap[end] * m.normal - (of_b ? to_b : Vec2(Vec2::Zero()));
            arm = own.c * corner + own.s * perp(corner) + (of_b ? apart : Vec2(Vec2::Zero()));
        }
        c.arm_a[end] = cross(arm, n);
        c.arm_b[end] = cross(arm - apart, n);
        if (end != nearest(m)) continue;
        c.arm_a[2] = cross(arm, perp(n));
        c.arm_b[2] = cross(arm - apart, perp(n));
    }
    prepare(c, bodies.softness);
}

// A corner goes along an arc: a velocity that has no part along the normal now would lift it off the face or press it in
// within the step, and one without a part along the face would let it slip. Blocks that turn about a corner are of second
// order by this. m/s2, of the corner against the face along the normal and perp(normal), while both bodies move on as they
// do.
Vec2 bend(const Manifold& m, const Bodies& bodies, const Vec2& from_a, const Touch& c, int end) {
    const Velocity &a = bodies.velocity[c.a], &b = bodies.velocity[c.b];
    if (a.spin == 0.0 && b.spin == 0.0) return Vec2::Zero();
    const Vec2 arm_a = m.point[end] + from_a, arm_b = arm_a - (bodies.position[c.b] - bodies.position[c.a]);
    const Vec2 inward = a.spin * a.spin * arm_a - b.spin * b.spin * arm_b;
    const Vec2 slip = Vec2(b.x - a.x, b.y - a.y) + b.spin * perp(arm_b) - a.spin * perp(arm_a);
    const Vec2 n = m.normal, t = perp(n);
    const double face = 2.0 * (m.face_of_b ? b.spin : a.spin);
    return {n.dot(inward) + face * t.dot(slip), t.dot(inward) - face * n.dot(slip)};
}

/// s, after the start of a step of dt, at which a gap closes that is `gap` (m) then and changes by `speed` (m/s, < 0) and
/// the acceleration of weight and loads (m/s2); without the latter a block that bounces gains m g2 dt2 / 6 each time.
double time_of_impact(double gap, double speed, double acceleration, double dt) {
    const double root = std::sqrt(std::max(speed * speed - 2.0 * acceleration * gap, 0.0));
    return std::clamp(2.0 * gap / (root - speed), 0.0, dt);
}

bool fits_bond(const Model& model, const Contact& c) { return c.face >= 0 && model.faces[c.face].bonded; }

}  // namespace

double Touches::fastest(const Model& model, const Motion& motion, const Bodies& bodies, bool rebounds) {
    double fastest = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        fastest = std::max(fastest, fastest_point(model, motion.position[b], bodies, b, rebounds));
    return fastest;
}

void Touches::find(const Model& model, const Placed& placed, const State& state, const Bodies& bodies,
                   std::span<const Velocity> before, bool rebounds, double fall, double dt) {
    const int n = static_cast<int>(state.contacts.list.size()), nb = model.blocks.size();
    if (static_cast<int>(hint_.size()) != n) hint_.assign(n, -1);
    found_.resize(n);
    speed_.resize(nb);
    for_all(nb, few, [&](int b) { speed_[b] = fastest_point(model, placed.block[b].position, bodies, b, rebounds); });
    for_all(n, few, [&](int i) {
        const Contact& c = state.contacts.list[i];
        const BlockId a = model.parts.block[c.part_a], b = model.parts.block[c.part_b];
        found_[i] = {};
        if (bodies.body_of[a] == bodies.body_of[b]) return;
        const double thickness = thinner(model, c);
        const double reach = 0.5 * dt * (speed_[a] + speed_[b]) + touching * thickness;
        found_[i] = find_manifold(PlacedPart(model, placed, c.part_a), PlacedPart(model, placed, c.part_b),
                                  placed.block[b].position - placed.block[a].position, reach, narrow * thickness, hint_[i]);
        if (found_[i].distance >= -came_in * thickness) return;
        const auto of = [&](BlockId block) {
            const Velocity& v = before[bodies.body_of[block]];
            const Vec2 u = velocity_at(v, placed.block[block].position - bodies.position[bodies.body_of[block]]);
            return Velocity{u.x(), u.y(), v.spin};
        };
        Manifold m = find_manifold(PlacedPart(model, placed, c.part_a), PlacedPart(model, placed, c.part_b),
                                   placed.block[b].position - placed.block[a].position, reach, narrow * thickness,
                                   {of(a), of(b), 0.5 * dt});
        if (m.count == 0) return;
        m.distance = found_[i].distance;
        found_[i] = m;
    });

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
        end_.resize(2 * touches_.size() + 2);
        for (int end = 0; end < m.count; ++end) {
            const double u = normal_velocity(c, bodies.velocity, end), gap = m.gap[end];
            const bool closes = gap + 0.5 * dt * u <= 0.0 || gap <= fall;
            const Vec2 bent = bend(m, bodies, from_a_.back(), c, end);
            c.least[end] = closes ? -0.5 * dt * bent.x() : -2.0 * gap / dt;
            if (end == nearest(m)) c.sticks = -0.5 * dt * bent.y();
            end_[2 * touches_.size() + end] = closes ? End::meets : End::comes_near;
        }
        c.friction = known.slipped && joint.weakens ? joint.tan_friction_residual : joint.tan_friction;
        if (fits_bond(model, known)) {  // it has slipped, or nothing of it is left
            const JointFace& face = model.faces[known.face];
            const double bonded = std::min(intact_length(model, state, known), m.length);
            const double rest = std::max(0.0, std::min(face.s1 - face.s0, m.length) - bonded);
            c.cohesion = (joint.cohesion * bonded + (joint.weakens ? joint.cohesion_residual * rest : 0.0)) * dt;
        }
        // What acted before; a moment about the middle tells how it was shared by the ends.
        if (known.normal_force > 0.0 && !known.struck && known.normal.dot(m.normal) > 0.99) {
            const double couple = known.moment / m.length;
            if (m.count == 2) {
                // One end alone: the stretch has hardly the length any more with which the moment was taken.
                const double rounding = 1e-3 * known.normal_force;
                const double first = 0.5 * known.normal_force - couple, second = 0.5 * known.normal_force + couple;
                c.p[0] = first > rounding ? first * dt : 0.0;
                c.p[1] = second > rounding ? second * dt : 0.0;
            } else {
                c.p[0] = known.normal_force * dt;
            }
            const double bound = c.friction * (c.p[0] + c.p[1]) + c.cohesion;
            c.p[2] = std::clamp(known.shear_force * dt, -bound, bound);
        }
        rebound_.push_back(joint.restitution);
        touches_.push_back(c);
        manifold_.push_back(m);
        slot_.push_back(i);
    }
    find_impacts(bodies, before, fall, dt);
}

// What closes faster than half a step of free fall hits at a time within the step, and bounces, if it does, from two steps
// on: what rests must not. Until then all else acts on the two bodies as before: a corner about which a block has turned
// carries weight until the next one lands, or the block would lose the share of a step each time. The impulse acts where the
// two are then: with the arms of the middle of the step a block that rocks would lose a share of its spin that depends on
// where in the step it lands.
void Touches::find_impacts(const Bodies& bodies, std::span<const Velocity> before, double fall, double dt) {
    impact_.assign(bodies.size(), none);
    ahead_.assign(touches_.size(), 0.0);
    landed_.assign(2 * touches_.size(), 0.0);
    hit_.assign(2 * touches_.size(), none);
    uneven_.assign(bodies.size(), {});
    bool any = false;
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        Touch& c = touches_[i];
        bool hits[2] = {};
        double first = 1.0;  // share of the step that is over then
        const double slowest = rebound_[i] > 0.0 ? 4.0 : 1.0;
        for (int end = 0; end < c.ends; ++end) {
            const double gap = manifold_[i].gap[end], change = normal_velocity(c, before, end);
            const double approach = -std::min(change, normal_velocity(c, bodies.velocity, end));
            const double bent = std::abs(bend(manifold_[i], bodies, from_a_[i], c, end).x());
            const double way = at_the_latest * dt * approach + 0.125 * bent * dt * dt;  // in half of the step
            hits[end] = !(c.p[end] > 0.0 || -change * dt <= slowest * fall || std::abs(gap) > way);
            if (!hits[end]) continue;
            // What else carries a block that does not bounce, such as the corner it rocks about, is not known here.
            const double gained = rebound_[i] > 0.0 ? normal_velocity(c, bodies.velocity, end) - change : 0.0;
            hit_[2 * i + end] = time_of_impact(gap - 0.5 * dt * change, change, gained / dt, dt) / dt;
            first = std::min(first, hit_[2 * i + end]);
        }
        if (!hits[0] && !hits[1]) continue;
        any = true;
        for (const int body : {c.a, c.b}) impact_[body] = std::min(impact_[body], first);
        ahead_[i] = (first - 0.5) * dt;
        set_arms(manifold_[i], from_a_[i], bodies, {ahead_[i], before[c.a], before[c.b]}, c);
        for (int end = 0; end < c.ends && rebound_[i] > 0.0; ++end) {
            if (!hits[end]) continue;
            const double change = normal_velocity(c, before, end);
            const double gained = normal_velocity(c, bodies.velocity, end) - change;  // by weight and loads
            const double leaves = -rebound_[i] * (change + first * gained), rest = 1.0 - first;
            c.least[end] = std::max(0.0, rest * gained + leaves);
            if (c.least[end] == 0.0) continue;
            end_[2 * i + end] = End::bounces;
            uneven_[c.a].bounces = uneven_[c.b].bounces = true;
            landed_[2 * i + end] = rest * dt * (leaves + 0.5 * rest * gained);
        }
    }
    if (!any) return;
    for (Touch& c : touches_) {
        const double share = std::min(impact_[c.a], impact_[c.b]);
        for (int k = 0; k < 3 && share <= 1.0; ++k) {
            c.earlier[k] = share * c.p[k];
            c.p[k] -= c.earlier[k];
        }
    }
    find_uneven(bodies, before);
}

void Touches::find_uneven(const Bodies& bodies, std::span<const Velocity> before) {
    gained_.assign(bodies.size(), {});
    for (const Touch& c : touches_) apply(c, c.earlier, bodies.softness, gained_);
    for (int q = 0; q < bodies.size(); ++q) {
        const double first = impact_[q];
        if (first > 1.0) continue;
        const Velocity &v = bodies.velocity[q], &v0 = before[q];
        const Velocity by_weight{v.x - v0.x, v.y - v0.y, v.spin - v0.spin};
        const double early = first * first, late = uneven_[q].bounces ? (1.0 - first) * (1.0 - first) : 0.0;
        uneven_[q].gained = {first * gained_[q].x + (early - late) * by_weight.x,
                             first * gained_[q].y + (early - late) * by_weight.y,
                             first * gained_[q].spin + (early - late) * by_weight.spin};
    }
}

// With the velocities v0 and v1 at the start and the end of the step, g that weight and earlier impulses add until the share
// f of it, and l that weight adds after it (nothing where the body is carried from then on): the way is dt/2 [f (2 v0 + g) +
// (1 - f) (2 v1 - l)], that of the mean velocity dt/2 (v0 + v1).
Velocity Touches::uneven_way(const Bodies& bodies, std::span<const Velocity> before, int body, double dt) const {
    if (!moved_by_impact(bodies, body)) return {};
    const Velocity &v0 = before[body], &v1 = bodies.velocity[body], &g = uneven_[body].gained;
    const double late = 1.0 - 2.0 * impact_[body];
    return {0.5 * dt * (late * (v1.x - v0.x) + g.x), 0.5 * dt * (late * (v1.y - v0.y) + g.y),
            0.5 * dt * (late * (v1.spin - v0.spin) + g.spin)};
}

void Touches::add_earlier() {
    pressed_.resize(2 * touches_.size());
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        Touch& c = touches_[i];
        for (int end = 0; end < 2; ++end) pressed_[2 * i + end] = c.p[end] > 0.0;
        for (int k = 0; k < 3; ++k) c.p[k] += c.earlier[k];
    }
}

double Touches::energy_of_later_landings(const Bodies& bodies, double speed, double together) const {
    double energy = 0.0;
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        const Touch& c = touches_[i];
        double first = none;  // share of the step
        for (const int body : {c.a, c.b})
            if (moved_by_impact(bodies, body)) first = std::min(first, impact_[body]);
        for (int end = 0; end < c.ends && rebound_[i] > 0.0 && first < none; ++end) {
            const End kind = end_[2 * i + end];
            const bool later = kind == End::bounces ? hit_[2 * i + end] > first + together : kind == End::comes_near;
            if (!later || c.p[end] == 0.0) continue;
            const double k = end == 0 ? c.k00 : c.k11;
            const double approach = k * c.p[end] - normal_velocity(c, bodies.velocity, end);
            if (approach > speed) energy += 0.5 * rebound_[i] * rebound_[i] * approach * approach / k;
        }
    }
    return energy;
}

// An impulse p at the time t_i of the step moves a body by (dt - t_i) M^-1 J^T p, not by half of dt. The time follows from
// the gap in the middle of the step and the speed of approach.
void Touches::take_to_time_of_impact(const Bodies& bodies, std::span<const Velocity> before, double exact, double dt,
                                     std::span<Velocity> displacement) const {
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        const Touch& c = touches_[i];
        double later[3] = {0.0, 0.0, 0.0}, pressed = 0.0;  // N s x s
        for (int end = 0; end < c.ends; ++end) {
            const double gap = manifold_[i].gap[end], approach = -normal_velocity(c, before, end);
            pressed += c.p[end] - c.earlier[end];
            if (hit_[2 * i + end] <= 1.0)
                later[end] = (0.5 - hit_[2 * i + end]) * dt * (c.p[end] - c.earlier[end]);
            else if (std::abs(gap) > exact && std::abs(gap) <= 0.51 * dt * approach)
                later[end] = -gap / approach * (c.p[end] - c.earlier[end]);
        }
        if (later[0] == 0.0 && later[1] == 0.0) continue;
        later[2] = (c.p[2] - c.earlier[2]) * (later[0] + later[1]) / pressed;
        apply(c, later, bodies.softness, displacement);
    }
}

bool Touches::correct(const Bodies& bodies, std::span<const Velocity> before, std::span<const Velocity> after, double exact,
                      double dt, std::vector<Velocity>& displacement) {
    constexpr int sweeps = 20;  // what is left comes in the next step
    struct Want {
        double least;
        bool pressed;
        double push = 0.0;
    };
    std::vector<std::array<Want, 2>> want(touches_.size());
    double worst = 0.0;
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        const Touch& c = touches_[i];
        for (int end = 0; end < c.ends; ++end) {
            const double gap = manifold_[i].gap[end];
            Want& w = want[i][end];
            w.pressed = pressed_[2 * i + end];
            const End kind = end_[2 * i + end];
            if (!w.pressed)
                w.least = -(gap + 0.5 * dt * normal_velocity(c, after, end));
            else if (kind == End::comes_near)
                w.least = -gap - 0.5 * dt * c.least[end];
            else if (kind == End::bounces)
                w.least = landed_[2 * i + end] - gap - 0.5 * dt * c.least[end];
            else
                w.least = -gap;
            worst = std::max(worst, w.pressed ? std::abs(w.least) : w.least);
        }
    }
    displacement.clear();
    if (worst <= exact) return false;
    displacement.assign(bodies.size(), {});
    take_to_time_of_impact(bodies, before, exact, dt, displacement);
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        double largest = 0.0;
        const auto one = [&](std::size_t i) {
            Touch& c = touches_[i];
            for (int end = 0; end < c.ends; ++end) {
                Want& w = want[i][end];
                const double k = end == 0 ? c.k00 : c.k11;
                double push = w.push - (normal_velocity(c, displacement, end) - w.least) / k;
                if (!w.pressed) push = std::max(push, 0.0);
                double change[3] = {0.0, 0.0, 0.0};
                change[end] = push - w.push;
                w.push = push;
                if (change[end] == 0.0) continue;
                largest = std::max(largest, std::abs(change[end]) * k);
                apply(c, change, bodies.softness, displacement);
            }
        };
        for (std::size_t i = 0; i < touches_.size(); ++i) one(i);
        for (std::size_t i = touches_.size(); i-- > 0;) one(i);
        if (largest <= std::max(0.1 * exact, 1e-3 * worst)) break;
    }
    return true;
}

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

bool Touches::moved_by_impact(const Bodies& bodies, int body) const {
    const Softness& soft = bodies.softness[body];
    return impact_[body] <= 1.0 && soft.x + soft.y + soft.spin > 0.0;
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
        c.sliding = std::abs(t->p[2]) >= bound * (1.0 - 1e-9) && std::abs(u1) > resolution;
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
