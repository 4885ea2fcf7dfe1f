#include "rigid/impulses.hpp"

#include <algorithm>
#include <cmath>

namespace talus::rigid {
namespace {

// Both ends so close together that rounding decides which carries what: (window / arm)^2 is of this size.
constexpr double nearly_one = 1e-10;

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
    p[0] = std::max(-q0 / c.k00, 0.0);
    p[1] = std::max(-(q1 + c.k01 * p[0]) / c.k11, 0.0);
}

/// One contact by itself; returns the largest change of a relative velocity, m/s. `norm` grows by the change in the measure
/// of kinetic energy.
double solve_one(Touch& c, std::span<const Softness> bodies, std::span<Velocity> v, double& norm) {
    const double old[3] = {c.p[0], c.p[1], c.p[2]};
    const Approach u = approach(c, v);
    const double u0 = along_normal(c, u, 0);
    if (c.ends == 2) {
        const double u1 = along_normal(c, u, 1);
        two_ends(c, u0 - c.least[0] - c.k00 * old[0] - c.k01 * old[1], u1 - c.least[1] - c.k01 * old[0] - c.k11 * old[1],
                 c.p);
    } else {
        c.p[0] = std::max(old[0] - (u0 - c.least[0]) / c.k00, 0.0);
    }
    double change[3] = {c.p[0] - old[0], c.p[1] - old[1], 0.0};
    if (change[0] != 0.0 || change[1] != 0.0) apply(c, change, bodies, v);
    const double bound = c.friction * (c.p[0] + c.p[1]) + c.cohesion;
    c.p[2] = std::clamp(old[2] - along_tangent(c, approach(c, v)) / c.kt, -bound, bound);
    const double sheared[3] = {0.0, 0.0, c.p[2] - old[2]};
    if (sheared[2] != 0.0) apply(c, sheared, bodies, v);
    const double d0 = change[0] * c.k00, d1 = change[1] * c.k11, dt = sheared[2] * c.kt;
    norm += change[0] * d0 + change[1] * d1 + sheared[2] * dt;
    return std::max({std::abs(d0), std::abs(d1), std::abs(dt)});
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

int ImpulseSolver::solve(std::span<Touch> touches, std::span<const Softness> bodies, std::span<Velocity> velocity,
                         Convergence until) {
    const int n = static_cast<int>(touches.size()), nb = static_cast<int>(velocity.size());
    double last_norm = 0.0;
    for (int sweep = 0; sweep < until.sweeps; ++sweep) {
        // What a sweep changes is taken against the state before it.
        impulse_.resize(3 * n);
        for (int i = 0; i < n; ++i) std::copy_n(touches[i].p, 3, &impulse_[3 * i]);
        velocity_.assign(velocity.begin(), velocity.end());
        double norm = 0.0, largest = 0.0;
        for (int i = 0; i < n; ++i) solve_one(touches[i], bodies, velocity, norm);
        for (int i = n - 1; i >= 0; --i) largest = std::max(largest, solve_one(touches[i], bodies, velocity, norm));
        norm = 0.0;
        for (int i = 0; i < n; ++i) {
            const Touch& c = touches[i];
            const double d[3] = {c.p[0] - impulse_[3 * i], c.p[1] - impulse_[3 * i + 1], c.p[2] - impulse_[3 * i + 2]};
            norm += d[0] * d[0] * c.k00 + d[1] * d[1] * c.k11 + d[2] * d[2] * c.kt;
        }
        if (largest <= until.tolerance || sweep + 1 == until.sweeps) return sweep + 1;

        const double share = sweep > 0 ? norm / last_norm : 2.0;
        last_norm = norm;
        if (share > 1.0) {  // got worse: begin anew along the gradient
            impulse_direction_.assign(3 * n, 0.0);
            velocity_direction_.assign(nb, {});
        }
        const double kept = share > 1.0 ? 0.0 : share;
        for (int i = 0; i < n; ++i)
            for (int k = 0; k < 3; ++k) {
                double& direction = impulse_direction_[3 * i + k];
                const double change = touches[i].p[k] - impulse_[3 * i + k];
                touches[i].p[k] += kept * direction;
                direction = kept * direction + change;
            }
        for (int b = 0; b < nb; ++b) {
            Velocity &direction = velocity_direction_[b], &v = velocity[b];
            const Velocity change{v.x - velocity_[b].x, v.y - velocity_[b].y, v.spin - velocity_[b].spin};
            v = {v.x + kept * direction.x, v.y + kept * direction.y, v.spin + kept * direction.spin};
            direction = {kept * direction.x + change.x, kept * direction.y + change.y, kept * direction.spin + change.spin};
        }
    }
    return until.sweeps;
}

}  // namespace talus::rigid
