// Small blocks step more often than large ones.
//
// A block whose own stable step is much shorter than those of the others is fast: it steps `substeps` times in a step, and
// so do the contacts that it has. All other forces kick once per step: weight, and contacts among slow blocks, at both its
// ends. What fast contacts do to a slow block kicks it at every substep. This is the impulse form of a leapfrog with several
// steps (Tuckerman, Berne and Martyna 1992): second order, symplectic, momentum kept by each kick. Its step is bound by
// resonance between the kicks and the fast oscillations, so it stays well below the limit of the slow blocks.
//
// Whether a slow block is looked at in substeps (near) only saves time: it moves in straight lines between its kicks, and
// where it is in between is found from where the line began.
#pragma once

#include "model/awake.hpp"
#include "model/model.hpp"
#include "model/placed.hpp"
#include "model/state.hpp"

#include <span>
#include <vector>

namespace talus {

/// Of its own stable step, what a slow block may have as its step: half of it gains little, at twice of it kicks resonate
/// with fast blocks.
inline constexpr double slow_share = 0.6;
inline constexpr int most_substeps = 8;  // more make the step longer than slow blocks allow in all but the widest mixtures

inline constexpr double worth_substeps = 1.2;  // gain below which they are not chosen: what they cost themselves

struct Substeps {
    int count = 1;                   // 1, 2, 4 or 8: halving exactly, the parts of a step add up to it
    std::vector<std::uint8_t> fast;  // [nb]; empty = none
    double gain = 1.0;               // contacts and blocks computed without substeps, over those with them
};

/// With a step of `step` (s) for slow blocks, and `limits` [nb] (s) of each block; `share` of its limit a block may use.
Substeps substeps_for(const Model& model, const State& state, std::span<const double> limits, int count, double step,
                      double share);

/// With a step that is given: `asked` of them, or (0) as many as bring the smallest block to `fraction` of its limit.
Substeps substeps_of_step(const Model& model, const State& state, std::span<const double> limits, int asked, double step,
                          double fraction);

/// That of 1, 2, 4 or 8 which saves most, with the step (s) that it goes with; `step` without any.
struct ChosenSubsteps {
    Substeps substeps;
    double step;
};
ChosenSubsteps choose_substeps(const Model& model, const State& state, std::span<const double> limits, double step,
                               double share);

/// Scratch: who is concerned by substeps; follows from State::fast, from what is frozen, and from the list of contacts.
class Paces {
public:
    bool known() const { return known_; }
    void forget() { known_ = false; }
    /// Who is what. Near are slow blocks that the list pairs with a fast one.
    void find(const Model& model, const State& state);
    /// After the list is made anew: where the fast contacts of near blocks are in it.
    void find_pulls(const Model& model, const State& state);

    const Awake& fast() const { return fast_; }                 // in `moving`, as in all of them: not frozen
    const Awake& inner() const { return inner_; }               // fast and near
    std::span<const BlockRange> slow() const { return slow_; }  // near or not

    void begin_step(const Model& model, const State& state);
    /// True if every slow block that is not near stays within its boxes until the end of a step of dt.
    bool others_stay(const Model& model, const Motion& motion, const Placed& placed, double skin, double dt) const;
    /// All slow blocks are near until the paces are found again; those that were not have moved on from where they are in
    /// `motion` since `parts` of the step.
    void all_become_near(const Model& model, const State& state, int parts);
    /// Brings near blocks to where they are after `parts` of a step, each of them `part` long (s).
    void move_near(int parts, double part, Motion& motion) const;
    /// The other slow ones.
    void move_others(double dt, Motion& motion) const;

    /// Sums what fast contacts do to near blocks now, and their weight and loads if they are carried.
    void sum_pulls(const Model& model, const State& state);
    /// [nb] 1 = carried by fast contacts as the step began: until its end their weight and loads pull with these, or what is
    /// in balance would be kicked to and fro.
    std::span<const std::uint8_t> carried() const { return carried_; }
    /// v += F/m x dt by these, after `parts` of the step, with its work in the ledger.
    void pull(const Model& model, int parts, double dt, State& state);
    /// Takes them out of the load: what is left kicks once in a step; and puts back what was there.
    void take_pulls(std::span<Force> load);
    void put_back(std::span<Force> load) const;
    /// Mean velocities over a step of `parts`, to where contacts among slow blocks look for velocities.
    void place_means(const Motion& motion, int parts, Placed& placed) const;

private:
    struct Line {                    // on which a near block moves
        Vec2 position;               // m, where it began
        Vec2 way = Vec2::Zero();     // m/s, velocities before it, each times its parts
        Vec2 weight = Vec2::Zero();  // N, of a carried block
        Force pull = {}, external = {}, load = {};
        double angle;       // rad, as it began
        double turn = 0.0;  // rad/s, as `way`
        BlockId block;
        int since;           // parts of the step, when it began
        int first_pull = 0;  // in pulls_, up to that of the next line

        bool pulls() const { return !pull.force.isZero(0.0) || pull.torque != 0.0; }
    };
    struct Pull {
        int slot;
        bool on_b;
    };
    void mark(const Model& model, const State& state, std::span<const std::uint8_t> near);

    bool known_ = false;
    Awake fast_, inner_;
    std::vector<BlockRange> slow_, others_;
    std::vector<std::uint8_t> carried_;  // [nb]
    std::vector<int> line_of_;           // [nb] in near_, -1 = none
    std::vector<Line> near_;             // by block
    std::vector<Pull> pulls_;            // in the order in which forces are summed
};

/// Forces of one kind of blocks at one end of a (sub)step.
struct HalfKick {
    std::span<const Force> load, damping;        // damping: share of it in the load; may be empty
    double time;                                 // s, since the start of the stage, at which they act
    double dt;                                   // s
    bool fast;                                   // of which loads of the scene count
    std::span<const std::uint8_t> carried = {};  // [nb] 1 = weight and loads are not in the load of this block; may be empty

    bool without_external(BlockId b) const { return !carried.empty() && carried[b]; }
};

/// v += F/m x dt along the axes that are free; the work of each kind, exactly that by which the kinetic energy changes, goes
/// into the ledger. Returns the largest speed of any corner after it, m/s.
double kick_and_book(const Model& model, std::span<const BlockRange> ranges, const HalfKick& half, State& state);

}  // namespace talus
