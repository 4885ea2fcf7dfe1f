// The list of contacts: which pairs are looked at, what they do to each other, and the sum over each block.
//
// State::contacts.list holds one entry for every pair of parts worth looking at, sorted by key. An entry is alive while it
// carries force or has memory; the others are only places kept ready, may come and go with the search and the skin, and are
// neither saved nor counted.
//
// Memory (bonds, initial stress, slip, dilation) ends by geometry alone: when the two parts are further apart than
// `memory_reach`, or when the faces have turned away from each other.
#pragma once

#include "model/model.hpp"
#include "model/placed.hpp"
#include "model/state.hpp"

#include <span>
#include <vector>

namespace talus {

/// A place in the list that carries nothing, and an edge that kept its two parts apart when they were looked at last: a hint
/// that saves time and cannot change a result, because it is tested before it is believed.
struct Idle {
    int slot = -1;  // in the list
    int edge = -1;  // global corner index; -1 = not known
    // The corners of the other part that can come nearest to that edge until the next refresh; mostly two, for joints run on
    // beyond a corner and blocks that meet there have an edge in line. -1 = there are more.
    int corner = -1, other_corner = -1;
    BlockId block_of_edge = -1, block_of_corner = -1;
    double touch_depth = 0.0;  // m, see touch_depth()
};

/// Scratch: follows from the list.
struct ContactIndex {
    struct Chunk {  // contacts [begin, end) of the list: those whose block a is one of a few neighbouring numbers
        int begin, end;
        std::vector<int> alive;  // slots, ascending
        std::vector<Idle> idle;  // all others, ascending
    };
    std::vector<Chunk> chunks;
    std::vector<int> first;  // [nb+1] entries of block b: [first[b], first[b+1]) of `entry`
    std::vector<int> entry;  // 2 x contact + side (0 = block is a, 1 = block is b), in key order
    double skin = 0.0;       // m, how far every point of a block stays from where it was at the refresh, per axis
};

/// m: how far apart two parts may be before their contact forgets.
double memory_reach(const Model& model, PartId a, PartId b);

/// m: depth up to which two parts only touch, 1e-12 of a block. The corners of cut rock overlap by their rounding; the force
/// of such a corner (kn depth^2, 1e-14 N) is nothing, but half of all pairs would go through the general law.
double touch_depth(const Model& model, PartId a, PartId b);

/// Makes the list anew: the given pairs of parts (sorted, as a search hands them over) and every contact that is alive.
/// Left out are pairs within one block, between blocks that cannot move, with removed blocks, and those too far apart to
/// touch before a block leaves its skin.
void refresh_contacts(const Model& model, const Placed& placed, std::span<const Pair> pairs, double skin, State& state,
                      ContactIndex& index);

/// Geometry and law of every contact in the list, for velocities of the half step before `now` and a step dt (0: forces
/// only). Adds what slip and dashpots dissipate to the ledger.
void update_contacts(const Model& model, const Placed& placed, double dt, State& state, ContactIndex& index);

/// load[b] += sum over its contacts, in key order. Contacts that carry nothing hold zeros, which change no bit of a sum.
void sum_contacts(const Model& model, const Contacts& contacts, const ContactIndex& index, std::span<Force> load);

/// J, elastic energy stored in the joints now: normal and shear.
struct StrainEnergy {
    double normal = 0.0, shear = 0.0;
};
StrainEnergy strain_energy(const Model& model, const Placed& placed, const State& state);

}  // namespace talus
