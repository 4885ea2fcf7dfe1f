// The list of contacts: which pairs are looked at, what they do to each other, and the sum over each block.
//
// State::contacts.list holds one entry for every pair of parts worth looking at, sorted by key. An entry is alive while it
// carries force or has memory; the others are only places kept ready, may come and go with the search and the skin, and are
// neither saved nor counted.
//
// Memory (bonds, initial stress, slip, dilation) ends by geometry alone: when the two parts are further apart than
// `memory_reach`, or when the faces have turned away from each other. Slip is remembered where it matters: on faces, and on
// joints that it weakens or thickens.
#pragma once

#include "contact/corner_batch.hpp"
#include "contact/face_batch.hpp"
#include "model/awake.hpp"
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
    double until = 0.0;        // m, sum of the paths of both blocks (Placed::path) below which nothing has to be tested
};

/// A plain face, alive: where the numbers stand that go into a FaceBatch, so that no chain of look-ups leads to them.
struct FaceSlot {
    int slot;  // in the list
    BlockId block_a, block_b;
    int a0, a1, b0, b1;  // corners at the ends of the two edges; those of a and of b start at a0 and at b1
    int joint;
};

/// Two corners, each inside the other part (global corner indices); see corner_pair().
struct CornerSlot {
    int slot;  // in the list
    BlockId block_a, block_b;
    int a, a_before, b, b_before;  // the corners, which their second edges start from, and where the first ones start
    double reach, touch_depth;     // m, as in CornerLines
};

/// Kept from step to step: to clear them would cost a scene of a few blocks a tenth of its step.
struct Batches {
    Batches();
    FaceBatch faces{};
    CornerBatch corners{};
};

/// Scratch: follows from the list.
struct ContactIndex {
    struct Chunk {  // contacts [begin, end) of the list: those whose block a is one of a few neighbouring numbers
        int begin = 0, end = 0;
        Pace pace = Pace::all;     // of those that are meant; with substeps there is one more chunk for each, of fast ones
        bool sorted = false;       // whether the kinds below are up to date but for `changed`; all ascending
        std::vector<int> changed;  // contacts that are perhaps of another kind now
        std::vector<FaceSlot> faces;      // alive, without intact bonds: computed many at a time, see FaceTable
        std::vector<CornerSlot> corners;  // alive: the same
        std::vector<int> others;          // alive: corners in faces, bonds, what has parted and remembers
        std::vector<Idle> idle;           // not alive; also before they are sorted, if nothing has begun or ended since
    };
    std::vector<Chunk> chunks;
    std::vector<Batches> batches;  // [threads]
    // Contacts in which block b is a: [first_a[b], first_a[b+1]) of the list. In which it is b: [first_b[b], first_b[b+1])
    // of `slot_b`, ascending; in the order of keys these come first.
    std::vector<int> first_a, first_b;  // [nb+1]
    std::vector<int> slot_b;            // [n]
    double skin = 0.0;                  // m, how far every point of a block stays from where it got its boxes, per axis
};

/// Whether a contact knows anything that outlasts a gap between its parts.
bool remembers(const Model& model, const Contact& contact);

/// m: how far apart two parts may be before their contact forgets.
double memory_reach(const Model& model, PartId a, PartId b);

/// m: depth up to which two parts only touch, 1e-12 of a block. The corners of cut rock overlap by their rounding; the force
/// of such a corner (kn depth^2, 1e-14 N) is nothing, but half of all pairs would go through the general law.
double touch_depth(const Model& model, PartId a, PartId b);

/// Renews the list: the given pairs of parts (sorted, as a search hands them over) and every contact that is alive. Left out
/// are pairs within one block, between blocks that cannot move, with removed blocks, and those too far apart to touch before
/// a block leaves its boxes. Only pairs with a block that was `reboxed` [nb] are looked at; what is known of others holds
/// until then. At first every block must be.
void refresh_contacts(const Model& model, const Placed& placed, std::span<const Pair> pairs,
                      std::span<const std::uint8_t> reboxed, double skin, State& state, ContactIndex& index);

/// To be called for every block that was frozen or woken since the last update.
void sort_contacts_again(const Model& model, const Contacts& contacts, BlockId block, ContactIndex& index);

/// By State::calm and by the places of the list, of which there may be more than touch. `changed`: the blocks that froze or
/// woke since `rest` [nb] was right.
void find_rest(const Model& model, const State& state, const ContactIndex& index, std::span<const BlockId> changed,
               std::span<Rest> rest);

/// Geometry and law of every contact in the list but those between two frozen blocks, for velocities of the half step before
/// `now` and a step dt (0: forces only); of one pace only, if that is asked. Adds what slip and dashpots dissipate to the
/// ledger.
void update_contacts(const Model& model, const Placed& placed, double dt, Pace pace, State& state, ContactIndex& index);

/// load[b] += sum over its contacts, in key order. Contacts that carry nothing hold zeros, which change no bit of a sum.
void sum_contacts(std::span<const BlockRange> ranges, const Contacts& contacts, const ContactIndex& index,
                  std::span<Force> load);

/// N: half of the sum of the magnitudes of the forces on a block: what its contacts hand on from one side to the other.
double handed_on(const Contacts& contacts, const ContactIndex& index, BlockId block);

/// J, elastic energy stored in the joints now: normal and shear.
struct StrainEnergy {
    double normal = 0.0, shear = 0.0;
};
StrainEnergy strain_energy(const Model& model, const Placed& placed, const State& state);

}  // namespace talus
