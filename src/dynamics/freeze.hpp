// Blocks at rest are frozen: they stay where they are, and contacts between two of them keep their forces without being
// computed. Contacts with blocks that move are computed as ever, so action is reaction.
//
// A block is calm when what is out of balance on it stays below a share e of the force N that its contacts hand on, or of
// its weight where that is more, and its speed so low that what it still could swing is below e N / K, with the stiffness K
// of its whole boundary. It is frozen when it was calm at State::calm_needed looks in a row, and wakes in the step in which
// more than 2 e N is out of balance: until then, what is left out of its motion is of the order of 2 e N / K, a share of
// what its joints are closed.
#pragma once

#include "model/awake.hpp"
#include "model/model.hpp"
#include "model/state.hpp"

#include <functional>
#include <span>

namespace talus {

// Steps between looks for blocks that have come to rest. Vibrations of a block last some 10 to 100 steps; half of it freezes
// blocks that only turn round, twice of it freezes them later.
inline constexpr int freeze_interval = 25;

struct Calm {
    double share;                              // e
    double gravity;                            // m/s2, now
    std::function<double(BlockId)> handed_on;  // N, by the contacts of a block; asked of few of them
};

/// Nothing is frozen but what is held for good, of which nothing has to be computed where it meets its like.
void wake_all(const Model& model, State& state);

/// Wakes frozen blocks whose load is out of balance. Returns whether there were any.
bool wake_disturbed(const Model& model, std::span<const BlockRange> ranges, const Calm& calm, State& state);

/// Counts looks at which blocks were calm, and freezes those that were so often enough: their velocities become zero.
/// Returns whether there were any.
bool freeze_calm(const Model& model, const Awake& awake, const Calm& calm, State& state);

}  // namespace talus
