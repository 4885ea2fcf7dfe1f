#include "model/measure.hpp"

#include "core/turn.hpp"
#include "model/select.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

constexpr double on_edge = 1e-9;  // m, a point this near to a block belongs to it

// N per block: sum of the magnitudes of the contact forces.
std::vector<double> contact_forces(const Model& model, const Contacts& contacts) {
    std::vector<double> sum(model.blocks.size(), 0.0);
    for (std::size_t i = 0; i < contacts.reaction.size(); ++i) {
        const double size = contacts.reaction[i].force.norm();
        sum[model.parts.block[contacts.list.key(i).part_a]] += size;
        sum[model.parts.block[contacts.list.key(i).part_b]] += size;
    }
    return sum;
}

}  // namespace

double kinetic_energy(const Model& model, const State& state) {
    // Held and driven axes have no part in it: their motion is given, whatever forces act.
    const Blocks& blocks = model.blocks;
    double energy = 0.0;
    for (BlockId b = 0; b < blocks.size(); ++b) {
        if (state.removed[b]) continue;
        const Vec2 v = (blocks.inv_mass[b].array() > 0.0).select(state.motion.velocity[b], 0.0);
        const double spin = blocks.inv_inertia[b] > 0.0 ? state.motion.spin[b] : 0.0;
        energy += 0.5 * blocks.mass[b] * v.squaredNorm() + 0.5 * blocks.inertia[b] * spin * spin;
    }
    return energy;
}

double out_of_balance(const Blocks& blocks, BlockId b, const Force& load) {
    const double x = blocks.inv_mass[b].x() > 0.0 ? load.force.x() : 0.0;
    const double y = blocks.inv_mass[b].y() > 0.0 ? load.force.y() : 0.0;
    const double gyration = std::sqrt(blocks.inertia[b] / blocks.mass[b]);
    const double couple = blocks.inv_inertia[b] > 0.0 ? load.torque / gyration : 0.0;
    return std::hypot(x, y, couple);
}

double unbalanced_ratio(const Model& model, const State& state) { return unbalance(model, state).ratio(); }

Unbalance unbalance(const Model& model, const State& state) {
    const std::vector<double> pressed = contact_forces(model, state.contacts);
    const double gravity = std::hypot(model.gravity_x(state.stage_time), model.gravity_y(state.stage_time));
    Unbalance found;
    int moving = 0;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (state.removed[b] || model.blocks.held(b)) continue;
        ++moving;
        Force load = state.load[b];
        if (!state.damping.empty()) {  // local damping hides up to its share of what is out of balance
            load.force -= state.damping[b].force;
            load.torque -= state.damping[b].torque;
        }
        found.largest = std::max(found.largest, out_of_balance(model.blocks, b, load));
        found.pressed += pressed[b];
        found.weight += model.blocks.mass[b] * gravity;
    }
    found.pressed /= std::max(moving, 1);
    found.weight /= std::max(moving, 1);
    return found;
}

double max_speed(const Model& model, const State& state) {
    double fastest = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        const double spin = std::abs(state.motion.spin[b]);
        if (!state.removed[b]) fastest = std::max(fastest, state.motion.velocity[b].norm() + spin * model.blocks.radius[b]);
    }
    return fastest;
}

BlockId block_at(const Model& model, const State& state, const Vec2& point) {
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        if (!state.removed[b] &&
            contains(model, b, turned(point - state.motion.position[b], -state.motion.angle[b]), on_edge))
            return b;
    return -1;
}

}  // namespace talus
