// Many contacts of one kind at a time, in vector registers: what all kinds have in common. Each kind adds its geometry.
#pragma once

#include "contact/response.hpp"
#include "contact/vector_unit.hpp"

namespace talus {

/// One row of numbers per quantity, one column per contact; names as in Approach, JointLaw, ShearMemory, Pressed and
/// Response. Flags are 0 or 1. What columns beyond `count` hold does not matter.
struct alignas(64) ContactBatch {
    static constexpr int size = 16;
    using Row = double[size];

    // what goes in
    Row dx, dy, vax, vay, spin_a, vbx, vby, spin_b;
    Row kn, ks, tan_friction, tan_friction_residual, cohesion_residual, weakens, tan_dilation, dilation_cutoff_slip;
    Row face_length;
    // what changes
    Row force, energy, slip, slip_sum, dilation, slipped, nx, ny;
    // what comes out
    Row valid, loaded, sliding, length, overlap, normal_force, strength, x, y;
    Row fx, fy, torque_a, torque_b, friction, damping, released;

    int slot[size];  // where each contact stands in the list
    int count = 0;

    [[gnu::always_inline]] JointLaw law(int i) const {
        JointLaw joint;
        joint.kn = kn[i], joint.ks = ks[i];
        joint.tan_friction = tan_friction[i], joint.tan_friction_residual = tan_friction_residual[i];
        joint.cohesion_residual = cohesion_residual[i], joint.weakens = weakens[i] != 0.0;
        joint.tan_dilation = tan_dilation[i], joint.dilation_cutoff_slip = dilation_cutoff_slip[i];
        return joint;
    }

    /// Slip has thickened a joint that dilates: the same as moving b against a by -this. The force acts at the true place,
    /// so that torques still balance.
    [[gnu::always_inline]] Vector thicker(int i) const { return {dilation[i] * nx[i], dilation[i] * ny[i]}; }

    /// From the normal part `p`, found with b moved by -`thicker`, to all that comes out but `valid` and `loaded`.
    [[gnu::always_inline]] void respond_to(int i, Pressed p, const JointLaw& joint, const Vector& thicker, double dt,
                                           double contact_damping) {
        p.torque_b -= thicker.x * p.fy - thicker.y * p.fx;
        ShearMemory shear;
        shear.force = force[i], shear.energy = energy[i], shear.slip = slip[i], shear.slip_sum = slip_sum[i];
        shear.dilation = dilation[i], shear.slipped = slipped[i];
        const Approach approach{vax[i], vay[i], spin_a[i], vbx[i], vby[i], spin_b[i], dx[i], dy[i]};
        const Response r = respond(joint, p, approach, dt, contact_damping, face_length[i], Vector{nx[i], ny[i]}, shear);
        force[i] = shear.force, energy[i] = shear.energy, slip[i] = shear.slip, slip_sum[i] = shear.slip_sum;
        dilation[i] = shear.dilation, slipped[i] = shear.slipped;
        sliding[i] = r.sliding ? 1.0 : 0.0;
        nx[i] = p.nx, ny[i] = p.ny, x[i] = p.x, y[i] = p.y, length[i] = p.length;
        overlap[i] = p.overlap, normal_force[i] = r.normal_force, strength[i] = r.strength;
        fx[i] = r.fx, fy[i] = r.fy, torque_a[i] = r.torque_a, torque_b[i] = r.torque_b;
        friction[i] = r.friction, damping[i] = r.damping, released[i] = r.released;
    }
};

}  // namespace talus
