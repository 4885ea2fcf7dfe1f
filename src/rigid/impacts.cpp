#include "rigid/touch_arms.hpp"

#include <algorithm>
#include <cmath>

namespace talus::rigid {
namespace {

constexpr double none = 2.0;  // share of a step: no impact in it
// Of a step, from its middle: what hits at its very end must not be missed by rounding, or the next step finds it inside.
constexpr double at_the_latest = 0.5 * (1.0 + 1e-9);

/// s, after the start of a step of dt, at which a gap closes that is `gap` (m) then and changes by `speed` (m/s, < 0) and
/// the acceleration of weight and loads (m/s2); without the latter a block that bounces gains m g2 dt2 / 6 each time.
double time_of_impact(double gap, double speed, double acceleration, double dt) {
    const double root = std::sqrt(std::max(speed * speed - 2.0 * acceleration * gap, 0.0));
    return std::clamp(2.0 * gap / (root - speed), 0.0, dt);
}

/// m/s, at which the two would come together at an end without the impulse there; 0 if there is none.
double approach_without(const Touch& c, const Bodies& bodies, int end) {
    if (c.p[end] == 0.0) return 0.0;
    return (end == 0 ? c.k00 : c.k11) * c.p[end] - normal_velocity(c, bodies.velocity, end);
}

}  // namespace

bool Touches::moved_by_impact(const Bodies& bodies, int body) const {
    const Softness& soft = bodies.softness[body];
    return impact_[body] <= 1.0 && soft.x + soft.y + soft.spin > 0.0;
}

double Touches::impact_of(const Bodies& bodies, int body) const {
    return moved_by_impact(bodies, body) ? impact_[body] : none;
}

// What closes faster than by what it gains in half a step hits at a time within the step, and bounces, if it does, from two
// steps on: what rests must not. Until then all else acts on the two bodies as before: a corner about which a block has
// turned carries weight until the next one lands, or the block would lose the share of a step each time. The impulse acts
// where the two are then: with the arms of the middle of the step a block that rocks would lose a share of its spin that
// depends on where in the step it lands.
void Touches::find_impacts(const Bodies& bodies, std::span<const Velocity> before, double dt) {
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
            const double approach = -std::min(change, normal_velocity(c, ahead_of_contacts(i, bodies), end));
            const double bent = std::abs(bend(manifold_[i], bodies, before, from_a_[i], c, end).x());
            const double way = at_the_latest * dt * approach + 0.125 * bent * dt * dt;  // in half of the step
            // What bounces does so though it is inside already: two tips that pass each other are seen when one is in a
            // face, and another impact of the step before may have sent it there.
            const bool in_reach = gap <= way && (gap >= -way || rebound_[i] > 0.0);
            hits[end] = in_reach && c.p[end] == 0.0 && -change * dt > slowest * near_[2 * i + end];
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
            c.along = c.against = 1.0;
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

void Touches::add_earlier(double resolution) {
    pressed_.resize(2 * touches_.size());
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        Touch& c = touches_[i];
        for (int end = 0; end < 2; ++end) pressed_[2 * i + end] = c.p[end] * (end == 0 ? c.k00 : c.k11) > resolution;
        for (int k = 0; k < 3; ++k) c.p[k] += c.earlier[k];
    }
}

/// Whether two come together before the end of the step because an impact before the middle of it has taken one further.
bool Touches::overtakes(std::size_t touch, int end, const Bodies& bodies, std::span<const Velocity> before,
                        double dt) const {
    const Touch& c = touches_[touch];
    const Velocity a = uneven_way(bodies, before, c.a, dt), b = uneven_way(bodies, before, c.b, dt);
    const double further = c.nx * (b.x - a.x) + c.ny * (b.y - a.y) + c.arm_b[end] * b.spin - c.arm_a[end] * a.spin;
    return manifold_[touch].gap[end] + 0.5 * dt * normal_velocity(c, bodies.velocity, end) + further < 0.0;
}

double Touches::energy_of_later_landings(const Bodies& bodies, std::span<const Velocity> before, double speed,
                                         double together, double dt) const {
    double energy = 0.0;
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        const Touch& c = touches_[i];
        const double first = std::min(impact_of(bodies, c.a), impact_of(bodies, c.b));
        for (int end = 0; end < c.ends && rebound_[i] > 0.0 && first < none; ++end) {
            const End kind = end_[2 * i + end];
            const bool later = kind == End::bounces ? hit_[2 * i + end] > first + together : kind == End::comes_near;
            const double approach = !later                                  ? 0.0
                                    : c.p[end] > 0.0                        ? approach_without(c, bodies, end)
                                    : overtakes(i, end, bodies, before, dt) ? -normal_velocity(c, bodies.velocity, end)
                                                                            : 0.0;
            if (approach > speed)
                energy += 0.5 * rebound_[i] * rebound_[i] * approach * approach / (end == 0 ? c.k00 : c.k11);
        }
    }
    return energy;
}

// The work of an impulse is p (u_before + u) / 2, whatever else acts at the same time: nothing with e = 1, as in an impact
// of two.
bool Touches::land_together(const Bodies& bodies, std::span<const Velocity> before, double speed, double dt) {
    bool any = false;
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        Touch& c = touches_[i];
        const double first = std::min(impact_of(bodies, c.a), impact_of(bodies, c.b));
        for (int end = 0; end < c.ends && rebound_[i] > 0.0 && first < none; ++end) {
            const std::size_t k = 2 * i + end;
            if (end_[k] != End::comes_near || approach_without(c, bodies, end) <= speed) continue;
            any = true;
            const double change = normal_velocity(c, before, end);
            c.least[end] = std::max(c.least[end], -rebound_[i] * change);
            end_[k] = End::bounces;
            hit_[k] = impact_[c.a] = impact_[c.b] = first;
            landed_[k] = manifold_[i].gap[end] + dt * ((first - 0.5) * change + (1.0 - first) * c.least[end]);
        }
    }
    return any;
}

}  // namespace talus::rigid
