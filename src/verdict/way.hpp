// How far blocks have gone, and which of them may go.
#pragma once

#include "model/model.hpp"
#include "model/state.hpp"

namespace talus {

// Of the way that the farthest corner goes by turning: less is none. In a mass that moves, blocks that slide turn by a few
// hundredths of their way; half of it would take some of these for toppling, twice of it would move the boundary between
// sliding and both, of a single block on a plane, by a third of a degree.
inline constexpr double a_part = 0.05;
/// Of one that touches nothing but what it slides on: it does not turn at all, unless its weight turns it.
inline constexpr double a_part_alone = 0.005;
/// Not held, driven or deleted.
bool free_to_move(const Model& model, const State& state, BlockId b);

/// m2, of all blocks that are free to move.
double free_area(const Model& model, const State& state);

/// m, square root of its area.
double size_of(const Model& model, BlockId b);

/// m, way of its farthest corner by turning by `angle` (rad).
double turning_way(const Model& model, BlockId b, double angle);

/// m, how far it has gone since the last reset: its centroid, or its farthest corner by turning, whichever is more.
double way_gone(const Model& model, const State& state, BlockId b);

/// The turn (rad) is more than a part of the way (m), and more than a block that rocks on its narrow side turns at most:
/// from one corner to over the other.
bool past_its_corner(const Model& model, BlockId b, double way, double angle);

/// Further than a block can rock to and fro: beyond its own size, or turned past its corner.
bool is_far(const Model& model, const State& state, BlockId b);

}  // namespace talus
