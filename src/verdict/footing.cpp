#include "verdict/footing.hpp"

#include "model/material_point.hpp"
#include "verdict/way.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

// Of its own way: a block that has moved by less than this on what carries it goes along with it. Half or twice of it
// matters to blocks only that slip a little on a mass that moves far.
constexpr double goes_along = 0.2;

}  // namespace

void Footing::find(const Model& model, const State& state) {
    contact_.assign(model.blocks.size(), -1);
    force_.assign(model.blocks.size(), 0.0);
    const Vec2 gravity(model.gravity_x(state.stage_time), model.gravity_y(state.stage_time));
    for (std::size_t i = 0; i < state.contacts.list.size(); ++i) {
        const Contact& c = state.contacts.list[i];
        if (!c.touching) continue;
        const Vec2& on_b = state.contacts.reaction[i].force;
        for (const int side : {-1, 1}) {
            const BlockId block = model.parts.block[side < 0 ? c.part_a : c.part_b];
            const double force = gravity.isZero() ? on_b.norm() : -side * on_b.dot(gravity);
            if (force <= force_[block]) continue;
            force_[block] = force;
            contact_[block] = static_cast<int>(i);
        }
    }
}

Base Footing::base(const Model& model, const State& state, BlockId b) const {
    for (int riders = 0; riders < model.blocks.size() && contact_[b] >= 0; ++riders) {
        const Contact& c = state.contacts.list[contact_[b]];
        const BlockId first = model.parts.block[c.part_a], second = model.parts.block[c.part_b];
        const BlockId below = first == b ? second : first;
        const Vec2 moved =
            fixed_to(state, b, c.point).displacement(state) - fixed_to(state, below, c.point).displacement(state);
        const double turned = turning_way(
            model, b, state.motion.angle[b] - state.start_angle[b] - (state.motion.angle[below] - state.start_angle[below]));
        if (!free_to_move(model, state, below) || std::max(moved.norm(), turned) > goes_along * way_gone(model, state, b))
            return {b, std::abs(moved.dot(perp(c.normal)))};
        b = below;
    }
    return {b};
}

}  // namespace talus
