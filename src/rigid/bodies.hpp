// Blocks that bonds hold together move as one body: what the rigid solver moves.
#pragma once

#include "model/model.hpp"
#include "model/state.hpp"
#include "rigid/impulses.hpp"

#include <span>
#include <vector>

namespace talus::rigid {

/// nq bodies, nb blocks. A body is a block by itself or several that share faces with intact bonds. What a bond to a held
/// block holds does not move either.
struct Bodies {
    std::vector<int> body_of;        // [nb]
    std::vector<int> first;          // [nq+1] blocks of body q are member[first[q]..first[q+1])
    std::vector<BlockId> member;     // [nb]
    std::vector<Softness> softness;  // [nq]
    std::vector<BlockId> driver;     // [nq] block of several that prescribes the motion of all of them, -1 = none
    std::vector<Vec2> position;      // [nq] m, centroid
    std::vector<Velocity> velocity;  // [nq]
    int size() const { return static_cast<int>(softness.size()); }
    bool single(int q) const { return first[q + 1] - first[q] == 1; }
};

/// m, of the bond cells of a contact that are not broken.
double intact_length(const Model& model, const State& state, const Contact& contact);

/// True while the two blocks at a joint face must move as one: some cells are intact and it has not slipped.
bool holds(const Model& model, const State& state, const Contact& contact);

/// Which blocks move as one now. Throws InputError where bonds join blocks that cannot: held along some axes only, or two
/// of which the motion is prescribed.
Bodies join_bonded(const Model& model, const State& state);

/// Of a body that moves with `block`, at `point` (m).
Velocity seen_from(const Motion& motion, BlockId block, const Vec2& point);

/// Takes positions and velocities of the bodies from those of the blocks.
void gather(const Model& model, const Motion& motion, Bodies& bodies);

/// Moves blocks with their bodies by velocity x dt, turning them about the centroid of the body.
void drift(const Bodies& bodies, double dt, Motion& motion, std::span<const Velocity> velocity);

/// Velocities of the blocks from those of their bodies.
void scatter(const Bodies& bodies, Motion& motion);

}  // namespace talus::rigid
