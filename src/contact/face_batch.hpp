// Plain contacts of faces (no intact bonds), many at a time: geometry, law and forces in vector registers. Most contacts of
// a rock mass are of this kind, and all of them go this way, so that a result does not depend on how they were grouped.
#pragma once

#include "contact/face_window.hpp"
#include "contact/response.hpp"
#include "contact/vector_unit.hpp"

namespace talus {

/// One row of numbers per quantity, one column per contact; names as in FaceLines, InitialClosure, Approach, JointLaw,
/// ShearMemory, Pressed and Response. Flags are 0 or 1.
struct alignas(64) FaceBatch {
    static constexpr int size = 16;
    using Row = double[size];

    // what goes in
    Row a0x, a0y, a1x, a1y, nax, nay, b0x, b0y, b1x, b1y, nbx, nby, dx, dy;
    Row a_lo, a_hi, b_lo, b_hi;
    Row remembers, s0, s1, sigma0, sigma1, face_length;  // sigma in Pa
    Row vax, vay, spin_a, vbx, vby, spin_b;
    Row kn, ks, tan_friction, tan_friction_residual, cohesion_residual, weakens, tan_dilation;
    Row dilation_cutoff_slip;
    // what changes
    Row force, energy, slip, slip_sum, dilation, slipped, nx, ny;
    // what comes out
    Row valid, loaded, sliding, length, overlap, normal_force, strength, x, y;
    Row fx, fy, torque_a, torque_b, friction, damping, released;

    int slot[size];  // where each contact stands in the list
    int count = 0;
};

/// Contacts [0, size) of the batch over a step dt (0: forces only); what columns beyond `count` hold does not matter.
/// `damping`: stiffness-proportional, s. The same bits with every unit.
using FaceKernel = void (*)(FaceBatch& batch, double dt, double damping);
FaceKernel face_kernel(VectorUnit unit);

}  // namespace talus
