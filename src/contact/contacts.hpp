// The list of contacts: which pairs are looked at, what they do to each other, and the sum over each block.
//
// State::contacts.list holds one entry for every pair of parts worth looking at, sorted by key. An entry is alive while it
// carries force or has memory; the others are only places kept ready, may come and go with the search and the skin, and are
// neither saved nor counted. In them edge_a remembers the edge that separated the pair last: a hint that saves time and
// cannot change a result, because it is tested before it is believed.
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

/// Scratch: follows from the list; made anew whenever the list changes.
struct Incidence {
    std::vector<int> first_of_a;  // [nb+1] contacts whose block a is b: [first_of_a[b], first_of_a[b+1])
    std::vector<int> first;       // [nb+1] entries of block b: [first[b], first[b+1]) of `entry`
    std::vector<int> entry;       // 2 x contact + side (0 = block is a, 1 = block is b), in key order
};

/// m: how far apart two parts may be before their contact forgets.
double memory_reach(const Model& model, PartId a, PartId b);

/// Makes the list anew: the given pairs of parts (sorted, as a search hands them over) and every contact that is alive.
/// Pairs within one block, between blocks that cannot move, and with removed blocks are left out.
void refresh_contacts(const Model& model, std::span<const Pair> pairs, State& state, Incidence& incidence);

/// Geometry and law of every contact in the list, for velocities of the half step before `now` and a step dt (0: forces
/// only). Adds what slip and dashpots dissipate to the ledger.
void update_contacts(const Model& model, const Placed& placed, double dt, State& state, const Incidence& incidence);

/// load[b] += sum over its contacts, in key order. Contacts that carry nothing hold zeros, which change no bit of a sum.
void sum_contacts(const Model& model, const Contacts& contacts, const Incidence& incidence, std::span<Force> load);

/// J, elastic energy stored in the joints now: normal and shear.
struct StrainEnergy {
    double normal = 0.0, shear = 0.0;
};
StrainEnergy strain_energy(const Model& model, const Placed& placed, const State& state);

}  // namespace talus
