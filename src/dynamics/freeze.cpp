#include "dynamics/freeze.hpp"

#include "dynamics/motion.hpp"
#include "model/measure.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

// N, without local damping: it hides up to its share of what is out of balance.
Force undamped(const State& state, BlockId b) {
    Force load = state.load[b];
    if (state.damping.empty()) return load;
    load.force -= state.damping[b].force;
    load.torque -= state.damping[b].torque;
    return load;
}

double boundary(const Model& model, BlockId b) {  // m
    double length = 0.0;
    for (int k = model.parts.first_corner[model.blocks.first_part[b]];
         k < model.parts.first_corner[model.blocks.first_part[b + 1]]; ++k)
        length += model.corners.length[k];
    return length;
}

void freeze(State& state, BlockId b) {
    state.motion.velocity[b].setZero();
    state.motion.spin[b] = 0.0;
    state.load[b] = undamped(state, b);
    if (!state.damping.empty()) state.damping[b] = {};
}

}  // namespace

void wake_all(const Model& model, State& state) {
    const int nb = model.blocks.size();
    state.calm.assign(nb, 0);
    for (BlockId b = 0; b < nb; ++b)
        if (state.removed[b] || (model.blocks.held(b) && state.motion.velocity[b].isZero() && state.motion.spin[b] == 0.0))
            state.calm[b] = State::calm_needed;
    for (const DrivenBlock& driven : model.driven) state.calm[driven.block] = 0;
}

bool wake_disturbed(const Model& model, std::span<const BlockRange> ranges, const Calm& calm, State& state) {
    bool woken = false;
    for (const BlockRange& range : ranges)
        for (BlockId b = range.begin; b < range.end; ++b) {
            if (!state.frozen(b) || model.blocks.held(b)) continue;
            const double weight = calm.gravity * model.blocks.mass[b];
            const double disturbed = out_of_balance(model.blocks, b, state.load[b]);
            if (disturbed <= 2.0 * calm.share * weight) continue;
            if (disturbed <= 2.0 * calm.share * calm.handed_on(b)) continue;
            state.calm[b] = 0;
            // It counts again in the kinetic energy of the ledger.
            state.ledger.kinetic0 -=
                0.125 * state.ledger_step() * state.ledger_step() * force_squared(model.blocks, b, state.load[b]);
            woken = true;
        }
    return woken;
}

bool freeze_calm(const Model& model, const Awake& awake, const Calm& calm, State& state) {
    bool frozen = false;
    double stiffest = 0.0;  // Pa/m
    for (const Joint& joint : model.joints) stiffest = std::max(stiffest, joint.kn);
    for (const BlockRange& range : awake.moving)
        for (BlockId b = range.begin; b < range.end; ++b) {
            if (model.blocks.held(b)) continue;  // or driven
            const double mass = model.blocks.mass[b];
            const double speed = state.motion.velocity[b].norm() + std::abs(state.motion.spin[b]) * model.blocks.radius[b];
            const double most = calm.share * std::max(calm.gravity * mass, calm.handed_on(b));
            const double slow = most / std::sqrt(mass * stiffest * boundary(model, b));
            const bool is_calm = speed < slow && out_of_balance(model.blocks, b, undamped(state, b)) < most;
            state.calm[b] = is_calm ? state.calm[b] + 1 : 0;
            if (!state.frozen(b)) continue;
            freeze(state, b);
            frozen = true;
        }
    return frozen;
}

}  // namespace talus
