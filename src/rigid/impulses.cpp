#include "rigid/impulses.hpp"

#include "rigid/coupled.hpp"
#include "rigid/direct.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace talus::rigid {
namespace {

// Both ends so close together that rounding decides which carries what: (window / arm)^2 is of this size.
constexpr double nearly_one = 1e-10;

// Of the softness of two bodies in all directions: what gives less along a joint is held there, but for rounding, which
// turns rollers by 1e-16. A wedge of 1e-6 rad would be as stiff.
constexpr double rigid = 1e-12;

// Sweeps after which what is left is solved directly, and direct solutions one after the other. A block on a chip of a
// millionth of its mass takes four; where ten would be needed sweeps do better.
constexpr int patience = 30;
constexpr int tries = 5;

struct Approach {  // of b against a
    double x, y, spin_a, spin_b;
};

Approach approach(const Touch& c, std::span<const Velocity> v) {
    const Velocity &a = v[c.a], &b = v[c.b];
    return {b.x - a.x, b.y - a.y, a.spin, b.spin};
}

double along_normal(const Touch& c, const Approach& u, int end) {
    return c.nx * u.x + c.ny * u.y + c.arm_b[end] * u.spin_b - c.arm_a[end] * u.spin_a;
}

double along_tangent(const Touch& c, const Approach& u) {
    return -c.ny * u.x + c.nx * u.y + c.arm_b[2] * u.spin_b - c.arm_a[2] * u.spin_a;
}

/// The same for one end by itself; what cannot give way knows no impulse.
double one_end(double k, double q) { return k > 0.0 ? std::max(-q / k, 0.0) : 0.0; }

/// Normal impulses >= 0 for which q + K p >= 0, and where p > 0 nothing is left of it.
void two_ends(const Touch& c, double q0, double q1, double p[2]) {
    const double det = c.k00 * c.k11 - c.k01 * c.k01;
    if (det > nearly_one * c.k00 * c.k11) {
        p[0] = (c.k01 * q1 - c.k11 * q0) / det;
        p[1] = (c.k01 * q0 - c.k00 * q1) / det;
        if (p[0] >= 0.0 && p[1] >= 0.0) return;
        p[0] = -q0 / c.k00;
        p[1] = 0.0;
        if (p[0] >= 0.0 && q1 + c.k01 * p[0] >= 0.0) return;
        p[0] = 0.0;
        p[1] = -q1 / c.k11;
        if (p[1] >= 0.0 && q0 + c.k01 * p[1] >= 0.0) return;
        p[1] = 0.0;
        return;
    }
    p[0] = one_end(c.k00, q0);
    p[1] = one_end(c.k11, q1 + c.k01 * p[0]);
}

/// The same for a contact whose friction changes its normal velocity.
bool solve_coupled(Touch& c, std::span<const Softness> bodies, std::span<Velocity> v, double& largest) {
    const double old[3] = {c.p[0], c.p[1], c.p[2]}, none[3] = {-old[0], -old[1], -old[2]};
    apply(c, none, bodies, v);
    const Approach u = approach(c, v);
    const double q[3] = {along_normal(c, u, 0) - c.least[0], c.ends == 2 ? along_normal(c, u, 1) - c.least[1] : 0.0,
                         along_tangent(c, u) - c.sticks};
    const bool found = solve_together(c, bodies, q);
    apply(c, c.p, bodies, v);
    largest =
        std::max({std::abs(c.p[0] - old[0]) * c.k00, std::abs(c.p[1] - old[1]) * c.k11, std::abs(c.p[2] - old[2]) * c.kt});
    return found;
}

/// One contact by itself; returns the largest change of a relative velocity, m/s.
double solve_one(Touch& c, std::span<const Softness> bodies, std::span<Velocity> v) {
    if (double largest; c.coupled && solve_coupled(c, bodies, v, largest)) return largest;
    const double old[3] = {c.p[0], c.p[1], c.p[2]};
    const Approach u = approach(c, v);
    const double u0 = along_normal(c, u, 0);
    if (c.ends == 2) {
        const double u1 = along_normal(c, u, 1);
        two_ends(c, u0 - c.least[0] - c.k00 * old[0] - c.k01 * old[1], u1 - c.least[1] - c.k01 * old[0] - c.k11 * old[1],
                 c.p);
    } else {
        c.p[0] = one_end(c.k00, u0 - c.least[0] - c.k00 * old[0]);
    }
    double change[3] = {c.p[0] - old[0], c.p[1] - old[1], 0.0};
    if (change[0] != 0.0 || change[1] != 0.0) apply(c, change, bodies, v);
    const double holds = old[2] - (along_tangent(c, approach(c, v)) - c.sticks) / c.kt;
    const double bound = c.friction * (c.p[0] + c.p[1]) + c.cohesion, least = -c.against * bound, most = c.along * bound;
    c.p[2] = std::clamp(holds, least, most);
    c.slips = c.p[2] <= least || c.p[2] >= most;
    const double sheared[3] = {0.0, 0.0, c.p[2] - old[2]};
    if (sheared[2] != 0.0) apply(c, sheared, bodies, v);
    const double d0 = change[0] * c.k00, d1 = change[1] * c.k11, dt = sheared[2] * c.kt;
    return std::max({std::abs(d0), std::abs(d1), std::abs(dt)});
}

/// One sweep to and fro; returns the largest change of a relative velocity, m/s.
double sweep_over(std::span<Touch> touches, std::span<const Softness> bodies, std::span<Velocity> velocity) {
    double largest = 0.0;
    for (Touch& c : touches) solve_one(c, bodies, velocity);
    for (std::size_t i = touches.size(); i-- > 0;) largest = std::max(largest, solve_one(touches[i], bodies, velocity));
    return largest;
}

}  // namespace

void prepare(Touch& c, std::span<const Softness> bodies) {
    const Softness &a = bodies[c.a], &b = bodies[c.b];
    const double x = a.x + b.x, y = a.y + b.y;
    const double along_n = c.nx * c.nx * x + c.ny * c.ny * y, along_t = c.ny * c.ny * x + c.nx * c.nx * y;
    const auto turning = [&](int i, int j) { return c.arm_a[i] * c.arm_a[j] * a.spin + c.arm_b[i] * c.arm_b[j] * b.spin; };
    c.k00 = along_n + turning(0, 0);
    c.k01 = along_n + turning(0, 1);
    c.k11 = along_n + turning(1, 1);
    c.kt = along_t + turning(2, 2);
    const auto reach = [](const double arm[3]) { return arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2]; };
    c.barely = rigid * (x + y + reach(c.arm_a) * a.spin + reach(c.arm_b) * b.spin);
    c.kt = std::max(c.kt, c.barely);  // friction of what slides along all the same is its bound
    if (c.k00 <= c.barely) c.k00 = c.k01 = 0.0;
    if (c.ends == 2 && c.k11 <= c.barely) c.k11 = c.k01 = 0.0;
}

void apply(const Touch& c, const double p[3], std::span<const Softness> bodies, std::span<Velocity> velocity) {
    const double n = p[0] + p[1];
    const double x = c.nx * n - c.ny * p[2], y = c.ny * n + c.nx * p[2];
    const Softness &a = bodies[c.a], &b = bodies[c.b];
    Velocity &va = velocity[c.a], &vb = velocity[c.b];
    va.x -= a.x * x;
    va.y -= a.y * y;
    va.spin -= a.spin * (c.arm_a[0] * p[0] + c.arm_a[1] * p[1] + c.arm_a[2] * p[2]);
    vb.x += b.x * x;
    vb.y += b.y * y;
    vb.spin += b.spin * (c.arm_b[0] * p[0] + c.arm_b[1] * p[1] + c.arm_b[2] * p[2]);
}

Solution ImpulseSolver::solve(std::span<Touch> touches, std::span<const Softness> bodies, std::span<Velocity> velocity,
                              Convergence until) {
    norm_ = 0.0;
    for (Touch& c : touches) c.coupled = coupled(c, bodies);
    double left = std::numeric_limits<double>::infinity();  // where sweeps alone had come when they were helped
    for (int sweep = 1;; ++sweep) {
        keep(touches, velocity);
        const double largest = sweep_over(touches, bodies, velocity);
        if (largest <= until.tolerance || sweep >= until.sweeps) return {sweep, largest};
        if (sweep % patience == 0 && largest < left) {
            const double helped = help(touches, bodies, velocity, largest, until.tolerance);
            if (helped <= until.tolerance) return {sweep, helped};
            left = helped < largest ? helped : 0.0;
            norm_ = 0.0;
            continue;
        }
        accelerate(touches, velocity);
    }
}

/// Direct solutions and sweeps in turn, for either finds which contacts press when the other has moved them; forgotten if
/// that leads away. Returns what is left then, m/s.
double ImpulseSolver::help(std::span<Touch> touches, std::span<const Softness> bodies, std::span<Velocity> velocity,
                           double left, double tolerance) {
    remember(touches, velocity);
    DirectSolver direct;
    double now = left;
    for (int i = 0; i < tries && now > tolerance; ++i) {
        if (!direct.solve(touches, bodies, velocity, tolerance)) {
            now = std::numeric_limits<double>::infinity();
            break;
        }
        now = sweep_over(touches, bodies, velocity);
    }
    if (now < left) return now;
    recall(touches, velocity);
    return left;
}

void ImpulseSolver::remember(std::span<const Touch> touches, std::span<const Velocity> velocity) {
    touches_before_.assign(touches.begin(), touches.end());
    velocity_before_.assign(velocity.begin(), velocity.end());
}

void ImpulseSolver::recall(std::span<Touch> touches, std::span<Velocity> velocity) const {
    std::ranges::copy(touches_before_, touches.begin());
    std::ranges::copy(velocity_before_, velocity.begin());
}

/// What a sweep changes is taken against the state before it.
void ImpulseSolver::keep(std::span<const Touch> touches, std::span<const Velocity> velocity) {
    impulse_.resize(3 * touches.size());
    for (std::size_t i = 0; i < touches.size(); ++i) std::copy_n(touches[i].p, 3, &impulse_[3 * i]);
    velocity_.assign(velocity.begin(), velocity.end());
}

/// Goes on along the direction of the sweeps before.
void ImpulseSolver::accelerate(std::span<Touch> touches, std::span<Velocity> velocity) {
    double norm = 0.0;
    for (std::size_t i = 0; i < touches.size(); ++i) {
        const Touch& c = touches[i];
        const double d[3] = {c.p[0] - impulse_[3 * i], c.p[1] - impulse_[3 * i + 1], c.p[2] - impulse_[3 * i + 2]};
        norm += d[0] * d[0] * c.k00 + d[1] * d[1] * c.k11 + d[2] * d[2] * c.kt;
    }
    const bool worse = !(norm <= norm_) || impulse_direction_.size() != impulse_.size();  // begin anew along the gradient
    const double kept = worse || norm == 0.0 ? 0.0 : norm / norm_;
    norm_ = norm;
    if (worse) {
        impulse_direction_.assign(3 * touches.size(), 0.0);
        velocity_direction_.assign(velocity.size(), {});
    }
    for (std::size_t i = 0; i < touches.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            double& direction = impulse_direction_[3 * i + k];
            const double change = touches[i].p[k] - impulse_[3 * i + k];
            touches[i].p[k] += kept * direction;
            direction = kept * direction + change;
        }
    for (std::size_t b = 0; b < velocity.size(); ++b) {
        Velocity &direction = velocity_direction_[b], &v = velocity[b];
        const Velocity change{v.x - velocity_[b].x, v.y - velocity_[b].y, v.spin - velocity_[b].spin};
        v = {v.x + kept * direction.x, v.y + kept * direction.y, v.spin + kept * direction.spin};
        direction = {kept * direction.x + change.x, kept * direction.y + change.y, kept * direction.spin + change.spin};
    }
}

}  // namespace talus::rigid
