// What carries a block, and whether the block slips on it.
#pragma once

#include "model/model.hpp"
#include "model/state.hpp"

#include <vector>

namespace talus {

/// m, how far the block has gone since the last reset: its centroid, or its farthest corner by turning, whichever is more.
double way_gone(const Model& model, const State& state, BlockId b);

/// The contact that carries each block: of those that press on it, the one that acts most against gravity. Scratch.
class Footing {
public:
    void find(const Model& model, const State& state);
    bool carried(BlockId b) const { return contact_[b] >= 0; }
    /// m, since the last reset along the joint on which the block moves. A block that goes along with what carries it moves
    /// on the joint on which that moves.
    double slip(const Model& model, const State& state, BlockId b) const;

private:
    std::vector<int> contact_;   // [nb] in the contact list, -1 = nothing carries it
    std::vector<double> force_;  // [nb] N, of that contact against gravity
};

}  // namespace talus
