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

/// Why a place in the list carries nothing: an edge that kept its two parts apart when they were looked at last. A hint that
/// saves time and cannot change a result, because it is tested before it is believed.
struct Idle {
    int edge = -1;  // global corner index; -1 = alive or not known
    int corner =
        -1;  // of the other part, nearest to that edge; -1 = another one may become the nearest until the next refresh
    BlockId block_of_edge = -1, block_of_corner = -1;
    double touch_depth = 0.0;  // m, see touch_depth()
};

/// Scratch: follows from the list, which changes only at a refresh.
struct ContactIndex {
    std::vector<int> first_of_a;  // [nb+1] contacts whose block a is b: [first_of_a[b], first_of_a[b+1])
    std::vector<int> first;       // [nb+1] entries of block b: [first[b], first[b+1]) of `entry`
    std::vector<int> entry;       // 2 x contact + side (0 = block is a, 1 = block is b), in key order
    std::vector<Idle> idle;       // [n]
    double skin = 0.0;            // m, how far every point of a block stays from where it was at the refresh, per axis
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
