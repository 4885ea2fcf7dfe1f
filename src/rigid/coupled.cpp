#include "rigid/coupled.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>

namespace talus::rigid {
namespace {

// Of the normal softness. At 1 sweeps do not converge; for blocks of 1:2 this is a friction of 50 degrees, and ordinary rock
// goes the fast way.
constexpr double much = 0.9;

constexpr double rounding = 1e-9;  // of the velocities

using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;

/// 1/kg, along the normal at an end per impulse along perp(normal).
double cross_softness(const Touch& c, std::span<const Softness> bodies, int end) {
    const Softness &a = bodies[c.a], &b = bodies[c.b];
    return c.nx * c.ny * (a.y + b.y - a.x - b.x) + c.arm_a[end] * c.arm_a[2] * a.spin + c.arm_b[end] * c.arm_b[2] * b.spin;
}

class OneContact {
public:
    OneContact(const Touch& c, std::span<const Softness> bodies, const double q[3]) : c_(c), q_{q[0], q[1], q[2]} {
        const double n0 = cross_softness(c, bodies, 0), n1 = c.ends == 2 ? cross_softness(c, bodies, 1) : 0.0;
        k_ << c.k00, c.k01, n0, c.k01, c.k11, n1, n0, n1, c.kt;
        small_ = rounding * std::max({std::abs(q[0]), std::abs(q[1]), std::abs(q[2])});
    }

    /// `ends`: bits of those that press. `way`: 0 sticks, 1 and -1: friction is at its bound along or against perp(normal).
    bool fulfils(unsigned ends, int way, double p[3]) const {
        std::array<int, 3> unknown;
        int n = 0;
        for (int i = 0; i < 2; ++i)
            if (ends >> i & 1U) unknown[n++] = i;
        const double share = way > 0 ? c_.along : way < 0 ? -c_.against : 0.0;
        if (way == 0) unknown[n++] = 2;
        p[0] = p[1] = 0.0;
        p[2] = share * c_.cohesion;
        if (n > 0) {
            Small k(n, n);
            Column v(n);
            for (int i = 0; i < n; ++i) {
                v[i] = -q_[unknown[i]] - (way == 0 ? 0.0 : k_(unknown[i], 2) * p[2]);
                for (int j = 0; j < n; ++j) k(i, j) = k_(unknown[i], unknown[j]) + share * c_.friction * k_(unknown[i], 2);
            }
            const Column found = k.fullPivLu().solve(v);
            for (int i = 0; i < n; ++i) p[unknown[i]] = found[i];
        }
        const double bound = c_.friction * (p[0] + p[1]) + c_.cohesion;
        if (way != 0) p[2] = share * bound;
        return possible(ends, way, p, bound);
    }

private:
    bool possible(unsigned ends, int way, const double p[3], double bound) const {
        double w[3];
        for (int i = 0; i < 3; ++i) w[i] = q_[i] + k_(i, 0) * p[0] + k_(i, 1) * p[1] + k_(i, 2) * p[2];
        for (int i = 0; i < c_.ends; ++i) {
            const double k = i == 0 ? c_.k00 : c_.k11;
            if (k == 0.0) continue;
            const bool presses = ends >> i & 1U;
            if (!(p[i] >= 0.0) || !(w[i] >= -small_) || (presses && !(w[i] <= small_))) return false;
        }
        if (way == 0) return std::abs(w[2]) <= small_ && p[2] <= c_.along * bound && p[2] >= -c_.against * bound;
        return way > 0 ? w[2] <= small_ : w[2] >= -small_;
    }

    const Touch& c_;
    double q_[3], small_;
    Eigen::Matrix3d k_;
};

}  // namespace

bool coupled(const Touch& c, std::span<const Softness> bodies) {
    for (int end = 0; end < c.ends; ++end) {
        const double k = end == 0 ? c.k00 : c.k11;
        if (k > 0.0 && c.friction * std::abs(cross_softness(c, bodies, end)) > much * k) return true;
    }
    return false;
}

bool solve_together(Touch& c, std::span<const Softness> bodies, const double q[3]) {
    const OneContact contact(c, bodies, q);
    const unsigned all = (c.k00 > 0.0 ? 1U : 0U) | (c.ends == 2 && c.k11 > 0.0 ? 2U : 0U);
    for (const unsigned ends : {0U, 3U, 1U, 2U})
        for (const int way : {0, 1, -1}) {
            double p[3];
            if ((ends & ~all) != 0 || !contact.fulfils(ends, way, p)) continue;
            std::copy_n(p, 3, c.p);
            c.slips = way != 0;
            return true;
        }
    return false;
}

}  // namespace talus::rigid
