// What carries a block, and on what it moves.
#pragma once

#include "model/model.hpp"
#include "model/state.hpp"

#include <vector>

namespace talus {

/// Where a block, or the mass that it goes along with, moves on something else.
struct Base {
    BlockId block;      // the lowest of the mass
    double slip = 0.0;  // m, of that block since the last reset, along the joint that carries it
};

/// The contact that carries each block: of those that press on it, the one that acts most against gravity. Scratch.
class Footing {
public:
    void find(const Model& model, const State& state);
    bool carried(BlockId b) const { return contact_[b] >= 0; }
    /// A block that goes along with what carries it has the base of that. Nothing carries the base of a mass that falls.
    Base base(const Model& model, const State& state, BlockId b) const;

private:
    std::vector<int> contact_;   // [nb] in the contact list, -1 = nothing carries it
    std::vector<double> force_;  // [nb] N, of that contact against gravity
};

}  // namespace talus
