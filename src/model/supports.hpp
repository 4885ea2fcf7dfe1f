// What holds, rolls or drives blocks.
#pragma once

#include "geometry/polygon.hpp"
#include "model/model.hpp"
#include "scenario/scenario.hpp"

#include <vector>

namespace talus {

enum class Side { left, right, bottom, top };
inline constexpr Side sides[] = {Side::left, Side::right, Side::bottom, Side::top};
inline constexpr const char* side_names[] = {"left", "right", "bottom", "top"};

struct OuterEdge {
    BlockId block;
    int corner, next;  // corner indices of its two ends
};

/// Edges of the first `blocks` blocks that lie on that extreme side of a box, to 1e-9 of its size.
std::vector<OuterEdge> edges_on_side(const Model& model, std::span<const Vec2> corner, int blocks, const Box& outline,
                                     Side side);

/// Applies the rules of `held` to the first `rock_blocks` blocks. A rule that finds no block is a fault: what its author
/// believes to be held would fall.
void hold_rock(const RockSpec& rock, std::span<const Vec2> corner, int rock_blocks, const Box& outline, Model& model,
               std::vector<Fault>& faults);

/// Holds or drives a single block.
void hold_block(const BlockSpec& spec, BlockId block, Model& model);

/// Blocks that never move: held along every axis and driven along none. [nb], 1 = never moves.
std::vector<std::uint8_t> immovable(const Model& model);

}  // namespace talus
