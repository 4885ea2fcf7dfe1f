#include "rigid/touch_arms.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace talus::rigid {

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
        double least = 0.0;
        bool pressed = false;
        double push = 0.0;
    };
    std::vector<std::array<Want, 2>> want(touches_.size());
    double worst = 0.0;
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        const Touch& c = touches_[i];
        for (int end = 0; end < c.ends; ++end) {
            if ((end == 0 ? c.k00 : c.k11) == 0.0) continue;
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
                if (k == 0.0) continue;
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

}  // namespace talus::rigid
