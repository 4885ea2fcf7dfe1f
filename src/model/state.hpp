// What a restart needs, and nothing else. Everything here is a pure function of the scenario and the number of steps: it
// depends neither on the search nor on the skin nor on the number of threads.
#pragma once

#include "core/types.hpp"
#include "model/contact_list.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace talus {

struct Motion {
    std::vector<Vec2> position;  // [nb] m, centroid
    std::vector<double> angle;   // [nb] rad, turned since the start
    std::vector<Vec2> velocity;  // [nb] m/s
    std::vector<double> spin;    // [nb] rad/s
};

struct Force {
    Vec2 force = Vec2::Zero();  // N
    double torque = 0.0;        // N m, about the centroid
};

/// What a contact puts on its two blocks.
struct Reaction {
    Vec2 force = Vec2::Zero();  // N, on b; a gets the opposite
    double torque_a = 0.0;      // N m, on a about its centroid
    double torque_b = 0.0;      // N m, on b about its centroid
};

struct Contacts {
    ContactList list;                  // [n] sorted by key
    std::vector<Reaction> reaction;    // [n]
    std::vector<std::uint8_t> broken;  // [cells] bond cells: 0 intact, 1 broken by tension, 2 by shear
};

/// Energies and work since the last reset, J. Work is that done on the blocks.
struct Ledger {
    double total0 = 0.0;    // Energies::total() at the start of the ledger
    double kinetic0 = 0.0;  // at the start of the ledger (product form, see dynamics/energy.hpp)
    double gravity = 0.0, loads = 0.0, contact = 0.0, local_damping = 0.0, driven = 0.0;  // work done on free blocks
    double friction = 0.0;                                                                // dissipated by slip, >= 0
    double contact_damping = 0.0;                                                         // dissipated by dashpots, >= 0
    double released = 0.0;  // elastic shear energy given up when contacts shrink or break, >= 0
    double gained = 0.0;    // most that ever was there beyond what can be explained, see Simulation::energy_gain
    double largest = 0.0;   // largest energy against which that is judged
};

/// How a static stage has gone so far, or how it ended.
struct StaticEvidence {
    int stage = 0;
    std::uint8_t reached = 0;       // 1 = equilibrium
    BlockId moving = -1;            // that keeps moving: there is no equilibrium; -1 = none was found
    double ratio = 0.0;             // unbalanced, of all of the load
    double drift = 0.0;             // largest speed x characteristic time / size of the block
    double loading_ratio = 0.0;     // largest unbalanced ratio while the load came on
    std::int64_t iterations = 0;    // of both kinds
    std::int64_t evaluations = 0;   // of all forces
    std::int64_t increments = 0;    // in which the load came on
    std::int64_t newton_steps = 0;  // that helped
};

/// A static stage on its way, see statics/static_solver.hpp; velocities are displacements per iteration there.
struct Statics {
    std::vector<Force> held_back;  // [nb] out of balance when the stage began
    double load_share = 1.0;       // of it that acts
    double load_rate = 0.0;        // per iteration
    double load_lag = 0.0;         // largest force out of balance, as a share of what the load does, see static_solver.hpp
    double pressed = 0.0;          // N, mean contact force of a block when the stage began
    std::vector<Vec2> position;    // [nb] m, at the start of the window from which damping is taken
    std::vector<double> angle;     // [nb] rad
    std::vector<Force> load;       // [nb]
    int window = 0;                // iterations since
    double damping = 0.0;          // of the relaxation, per iteration
    double shift = 0.0;            // of the matrix of Newton's method, in scaled masses
    std::int64_t polish_at = 0;    // iteration at which Newton's method is tried next
    std::int64_t patience = 0;     // iterations to wait when it fails next
    double push = 0.0;             // off the next equilibrium that is unstable, in steps of Newton::unstable
    std::vector<Vec2> start;       // [nb] m, position at the start of the stage
    std::int64_t look_at = 0;      // iteration of the next look whether something keeps moving
    double look_share = 0.0;       // of the load, what the last one saw
    double look_ratio = 0.0;
    double look_distance = 0.0;  // m
    int suspicious = 0;          // looks in a row that saw no progress
    StaticEvidence now;
    std::vector<StaticEvidence> earlier;  // static stages that are over
    std::vector<double> newton_ratios;    // unbalanced after each step of Newton that helped, of all static stages
};

/// A stage that was to end in equilibrium and ran out of time or iterations, or in which something keeps moving.
struct Unsettled {
    int stage = 0;
    double ratio = 0.0;  // unbalanced, at its end
};

/// What sweeps of the rigid solver left when there were too many of them.
struct Unsolved {
    std::int64_t steps = 0;  // in which that was
    double speed = 0.0;      // m/s, largest relative velocity that was still to change
    double way = 0.0;        // m, sum of these speeds times the steps: how far blocks may have crept
};

enum class Stability : std::uint8_t { undecided, stable, unstable };
enum class Mechanism : std::uint8_t { none, slide, topple, slide_and_topple, fall, rotation };

/// How a block set out: when it had first moved by a visible part of its size, see verdict/course.hpp.
enum class SetOut : std::uint8_t { not_yet, without_slip, with_slip };

/// How blocks went on, in windows of time: what a verdict is made from. Empty before the recorded stages.
struct Course {
    double window = 0.0;        // s, length of the window of now; 0 = none
    double window_begin = 0.0;  // s, since the last reset
    double next_look = 0.0;     // s
    std::int64_t looks = 0;     // in this window
    double give = 0.0;          // m, what springs account for
    double kinetic = 0.0;       // J, sum over the looks of this window
    double kinetic_last = 0.0;  // J, means of the last two windows
    double kinetic_before = 0.0;
    std::vector<Vec2> sum;             // [nb] m, displacements summed over the looks of this window
    std::vector<double> turn_sum;      // [nb] rad
    double mean_time = 0.0;            // s, middle of the last window
    std::vector<Vec2> mean;            // [nb] m, mean displacement in it
    std::vector<double> turn_mean;     // [nb] rad
    std::vector<Vec2> velocity;        // [nb] m/s, from the mean of the window before to that of the last one
    std::vector<Vec2> velocity_begin;  // [nb] m/s, when this window began
    std::vector<std::uint8_t> fell;    // [nb] nothing carried it in the last window
    std::vector<double> speed;         // [nb] m/s, of the farthest point, between the same means
    std::vector<double> speed_before;  // [nb] m/s, one window earlier
    std::vector<std::uint8_t> going;   // [nb] windows in a row in which it went on no slower than before
    std::vector<double> reach;         // [nb] m, farthest mean from the start
    // Windows in a row, with all loads on, in which the block was at rest, and in which it came no further.
    std::vector<std::uint8_t> rested, no_further;  // [nb]
    std::vector<SetOut> set_out;                   // [nb]
    std::vector<Mechanism> mechanism;              // [nb] of blocks that are known to be on their way; none: not known
    Stability verdict = Stability::undecided;
    double certain_at = 0.0;  // s, since the last reset
};

/// How often something is computed: with the blocks that take substeps, or once in a step. A contact is as fast as the
/// faster of its blocks.
enum class Pace : std::uint8_t { all, slow, fast };

struct State {
    double time = 0.0;        // s, since the last reset
    double stage_time = 0.0;  // s, since the stage began
    int calm_checks = 0;      // looks in a row at which the unbalanced ratio was below its limit
    std::int64_t step = 0;    // since the last reset
    std::int64_t total_steps = 0;
    int stage = 0;            // index into the list of stages; the last one is `run`
    double stage_step = 0.0;  // s, chosen at the start of the stage
    int step_halvings = 0;    // dt = stage_step / 2^step_halvings
    int substeps = 1;         // of fast blocks in a step
    Motion motion;
    std::vector<Force> load;     // [nb] sum of all forces at `time`, also on held blocks
    std::vector<Force> damping;  // [nb] share of local damping in it; empty = none
    Contacts contacts;
    std::vector<std::uint8_t> calm;     // [nb] looks in a row at which the block was at rest; empty = nothing is frozen
    std::vector<std::uint8_t> fast;     // [nb] 1 = steps `substeps` times in a step; empty = all step alike
    std::vector<std::uint8_t> removed;  // [nb] deleted by a stage
    std::vector<Force> release;         // [nb] forces of deleted neighbours that fade away in this stage; empty = none
    std::vector<Vec2> start_position;   // [nb] m, position and angle from which displacements count
    std::vector<double> start_angle;    // [nb] rad
    Ledger ledger;
    double earlier_gain = 0.0;  // energy_gain before the last reset
    Statics statics;
    std::vector<Unsettled> unsettled;
    Unsolved unsolved;
    Course course;

    static constexpr std::uint8_t calm_needed = 2;
    /// At rest, see dynamics/freeze.hpp.
    bool frozen(int block) const { return !calm.empty() && calm[block] >= calm_needed; }
    bool is_fast(int block) const { return !fast.empty() && fast[block]; }
    bool has(Pace pace, int block) const { return pace == Pace::all || is_fast(block) == (pace == Pace::fast); }
    /// s: the ledger of kick-drift-kick takes kinetic energy by the velocities half of it before and after; with substeps,
    /// of which blocks have different ones, by those of now, and books each kick by itself.
    double ledger_step() const { return fast.empty() ? stage_step : 0.0; }
};

}  // namespace talus
