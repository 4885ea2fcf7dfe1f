// A point that moves with its block.
#pragma once

#include "core/turn.hpp"
#include "model/state.hpp"

namespace talus {

struct MaterialPoint {
    BlockId block;
    Vec2 arm;  // m, from the centroid, unrotated

    Vec2 now(const State& s) const { return s.motion.position[block] + turned(arm, s.motion.angle[block]); }
    /// Since the start, or the last reset of displacements; without the difference of two large coordinates.
    Vec2 displacement(const State& s) const {
        return s.motion.position[block] - s.start_position[block] + turned(arm, s.motion.angle[block]) -
               turned(arm, s.start_angle[block]);
    }
    Vec2 velocity(const State& s) const {
        return s.motion.velocity[block] + s.motion.spin[block] * perp(now(s) - s.motion.position[block]);
    }
};

/// The point of the block that is at this place now.
inline MaterialPoint fixed_to(const State& state, BlockId block, const Vec2& place) {
    return {block, turned(place - state.motion.position[block], -state.motion.angle[block])};
}

}  // namespace talus
