// Numbers read off a state: energies, unbalanced ratio, largest movers. Nothing here changes anything.
#pragma once

#include "model/model.hpp"
#include "model/state.hpp"

#include <algorithm>

namespace talus {

/// J per m of thickness. Stored energies at this instant, dissipated and external work since the last reset.
struct Energies {
    double kinetic = 0.0;
    double strain_normal = 0.0, strain_shear = 0.0;                                     // stored in the joints
    double friction = 0.0, contact_damping = 0.0, local_damping = 0.0, released = 0.0;  // dissipated, >= 0
    double gravity = 0.0, loads = 0.0, driven = 0.0;                                    // work done on the blocks
    /// kinetic + stored + dissipated - external work: constant up to the oscillation of the integrator, (omega dt)^2.
    double total() const {
        return kinetic + strain_normal + strain_shear + friction + contact_damping + local_damping + released - gravity -
               loads - driven;
    }
};

/// Of the axes that are neither held nor driven, J.
double kinetic_energy(const Model& model, const State& state);

/// max |out-of-balance force| over blocks that can move / mean over the same blocks of the sum of contact force magnitudes
/// (or of the weights, whichever is larger); torques count divided by the radius of gyration, held and driven axes not at
/// all. Dimensionless; 0 in equilibrium, infinite if nothing but an applied load acts.
double unbalanced_ratio(const Model& model, const State& state);

/// N, what the unbalanced ratio is made of.
struct Unbalance {
    double largest = 0.0;  // force out of balance, of a block
    double pressed = 0.0;  // mean sum of contact force magnitudes
    double weight = 0.0;   // mean
    double ratio() const { return largest == 0.0 ? 0.0 : largest / std::max(pressed, weight); }
};
Unbalance unbalance(const Model& model, const State& state);

/// N, what is left over of a load along the axes in which the block is free; a torque counts divided by the radius of
/// gyration.
double out_of_balance(const Blocks& blocks, BlockId b, const Force& load);

double max_speed(const Model& model, const State& state);  // m/s, of any corner (bound: |v| + |spin| radius)

/// Block that contains the point now, -1 if none; the first one if several do (touching edges).
BlockId block_at(const Model& model, const State& state, const Vec2& point);

}  // namespace talus
