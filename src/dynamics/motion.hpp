// Moving blocks: kick-drift-kick, the two halves of a leapfrog step (velocity Verlet). Second order, symplectic.
#pragma once

#include "model/awake.hpp"
#include "model/model.hpp"
#include "model/placed.hpp"
#include "model/state.hpp"

#include <span>

namespace talus {

/// v += F/m x dt along the axes that are free.
void kick(const Model& model, const Awake& awake, std::span<const Force> load, Motion& motion, double dt);

/// x += v dt, angle += spin dt.
void drift(const Awake& awake, Motion& motion, double dt);

/// Sets the velocities that are prescribed at time t.
void drive(const Model& model, double t, Motion& motion);

/// Turns corners and normals to the present angles; blocks that never turn or are frozen are placed while there are no boxes
/// yet. Returns whether there are none, or a point of a block may have moved further along an axis than `skin` since it got
/// its boxes.
bool place(const Model& model, const Awake& awake, const Motion& motion, double skin, Placed& placed);

/// Share of the forces of deleted neighbours that is still there, 1 at the start of the stage, 0 after model.release_time.
double release_share(const Model& model, double stage_time);

/// load = weight + what is left of the forces of deleted neighbours, at state.stage_time.
void weigh(const Model& model, std::span<const BlockRange> ranges, const State& state, std::span<Force> load);

/// load += loads of the scene on blocks of a pace, at state.stage_time.
void add_loads(const Model& model, const State& state, Pace pace, std::span<Force> load);

/// m/s2, mean gravity over the step of dt that begins at stage_time.
Vec2 mean_gravity(const Model& model, double stage_time, double dt);

/// load = the mean of both over the step of dt that begins at state.stage_time, with blocks as they are turned now. Time
/// tables are integrated exactly: a pulse gives all of its impulse wherever in a step it ends.
void weigh_over(const Model& model, const State& state, double dt, std::span<Force> load);

/// Cundall's local damping, per degree of freedom that is free: damping = -alpha |F| sign(v), added to the load.
void damp_locally(const Model& model, const Awake& awake, const Motion& motion, std::span<Force> load,
                  std::vector<Force>& damping);

/// Forces at one end of a step: what the ledger needs to tell the work of each kind apart.
struct StepEnd {
    std::span<const Force> load, damping;
};

/// Adds the work of the step dt that ends at `state` (velocities still those of the half step) to the ledger, with the mean
/// of the forces at both its ends: exact for kick-drift-kick when the kinetic energy is taken as kinetic_energy_of_ledger
/// does. Returns the largest speed of any corner, m/s.
double account(const Model& model, const Awake& awake, const StepEnd& before, const StepEnd& after, const State& state,
               double dt, Ledger& ledger);

/// N2/kg, F M^-1 F over the axes that are free.
inline double force_squared(const Blocks& blocks, BlockId b, const Force& load) {
    return load.force.cwiseAbs2().dot(blocks.inv_mass[b]) + load.torque * load.torque * blocks.inv_inertia[b];
}

/// Force and torque of a load at t, on a block turned by `angle`.
Force load_at(const Load& load, double t, double angle);

/// J, (m/2) v(t - dt/2) . v(t + dt/2) summed over the free blocks: changes by exactly the mid-step work. With substeps, dt
/// of fast blocks is shorter by as much as theirs are.
double kinetic_energy_of_ledger(const Model& model, const State& state, double dt);

/// J: kinetic energy less the work done since the start of the ledger; zero but for rounding with dt = stage_step, also if
/// single steps were shorter.
double ledger_error(const Model& model, const State& state, double dt);

}  // namespace talus
