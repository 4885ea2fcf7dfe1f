#include "statics/relaxation.hpp"

#include "statics/chunk_sum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace {

using Vector3 = Eigen::Vector3d;

void begin_window(ScaledMass& mass, State& state) {
    Statics& s = state.statics;
    s.position = state.motion.position;
    s.angle = state.motion.angle;
    s.load = state.load;
    s.window = 0;
    mass.turn_to(s.angle);
}

// At most 4, the limit of the step.
double rayleigh_quotient(const ScaledMass& mass, const State& state) {
    const Statics& s = state.statics;
    const auto moved = [&](int b) {
        const Vec2 d = state.motion.position[b] - s.position[b];
        return Vector3(d.x(), d.y(), state.motion.angle[b] - s.angle[b]);
    };
    const double work =
        chunk_sum(mass.size(), [&](int b) { return moved(b).dot(components(s.load[b]) - components(state.load[b])); });
    const double size = chunk_sum(mass.size(), [&](int b) { return moved(b).dot(mass.mass(b) * moved(b)); });
    return work > 0.0 ? std::min(work / size, 4.0) : 0.0;
}

}  // namespace

double largest_rate(const Model& model, const Motion& motion) {
    double largest = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        const double size = motion.velocity[b].norm() + std::abs(motion.spin[b]) * model.blocks.radius[b];
        largest = std::isfinite(size) ? std::max(largest, size) : std::numeric_limits<double>::infinity();
    }
    return largest;
}

void start_relaxation(ScaledMass& mass, State& state) {
    std::ranges::fill(state.motion.velocity, Vec2::Zero());
    std::ranges::fill(state.motion.spin, 0.0);
    state.statics.damping = 0.0;
    begin_window(mass, state);
}

void relax(const Model& model, ScaledMass& mass, double longest, const Forces& forces, State& state) {
    Motion& motion = state.motion;
    const double c = state.statics.damping;
    const int nb = mass.size();
#pragma omp parallel for schedule(static)
    for (int b = 0; b < nb; ++b) {
        const Vector3 v = ((2.0 - c) * rate_of(motion, b) + 2.0 * (mass.inverse(b) * components(state.load[b]))) / (2.0 + c);
        motion.velocity[b] = {v.x(), v.y()};
        motion.spin[b] = v.z();
    }
    const double largest = largest_rate(model, motion), share = largest > longest ? longest / largest : 1.0;
#pragma omp parallel for schedule(static)
    for (int b = 0; b < nb; ++b) {
        motion.velocity[b] *= share;
        motion.spin[b] *= share;
        motion.position[b] += motion.velocity[b];
        motion.angle[b] += motion.spin[b];
    }
    forces.evaluate();
    if (++state.statics.window < damping_window) return;
    state.statics.damping = 2.0 * std::sqrt(rayleigh_quotient(mass, state));
    begin_window(mass, state);
}

}  // namespace talus
