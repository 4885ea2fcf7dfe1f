// Many contacts of one kind at a time, in vector registers: what all kinds have in common. Each kind adds its geometry.
#pragma once

#include "contact/response.hpp"
#include "contact/vector_unit.hpp"
#include "model/contact_list.hpp"

namespace talus {

/// What a step needs and finds beside what contacts know (ContactColumns); one row of numbers per quantity, one column per
/// contact, names as in Approach, JointLaw and Response. What columns beyond `count` hold does not matter to the others, but
/// they are computed too, up to a whole number of `group`s: left to chance they hold denormal numbers, at ten times the
/// cost.
struct alignas(64) ContactBatch {
    static constexpr int size = ContactColumns::size;
    static constexpr int group = 8;  // the widest vector register
    using Row = ContactColumns::Row;

    // what goes in
    Row position_x, position_y, dx, dy, vax, vay, spin_a, vbx, vby, spin_b;  // positions of a; b from a
    Row kn, ks, tan_friction, tan_friction_residual, cohesion_residual, weakens, tan_dilation, dilation_cutoff_slip;
    // what comes out
    Row valid, loaded;
    Row fx, fy, torque_a, torque_b, friction, damping, released;

    int slot[size];      // where each contact stands in the list
    int joint_of[size];  // whose numbers stand there, -1 = none
    int count = 0;

    [[gnu::always_inline]] JointLaw law(int i) const {
        JointLaw joint;
        joint.kn = kn[i], joint.ks = ks[i];
        joint.tan_friction = tan_friction[i], joint.tan_friction_residual = tan_friction_residual[i];
        joint.cohesion_residual = cohesion_residual[i], joint.weakens = weakens[i] != 0.0;
        joint.tan_dilation = tan_dilation[i], joint.dilation_cutoff_slip = dilation_cutoff_slip[i];
        return joint;
    }

    /// From the normal part `p`, found with b moved by -`thicker`, to all that comes out but `valid` and `loaded`. Where the
    /// contact does not `count` its column stays as it is.
    [[gnu::always_inline]] void respond_to(int i, ContactColumns& c, bool counts, Pressed p, const JointLaw& joint,
                                           const Vector& thicker, double face_length, double dt, double contact_damping) {
        p.torque_b -= thicker.x * p.fy - thicker.y * p.fx;
        ShearMemory shear;
        shear.force = c.force[i], shear.energy = c.energy[i], shear.slip = c.slip[i], shear.slip_sum = c.slip_sum[i];
        shear.dilation = c.dilation[i], shear.slipped = c.slipped[i];
        const Approach approach{vax[i], vay[i], spin_a[i], vbx[i], vby[i], spin_b[i], dx[i], dy[i]};
        const Response r = respond(joint, p, approach, dt, contact_damping, face_length, Vector{c.nx[i], c.ny[i]}, shear);
        const auto keep = [&](ContactColumns::Row& row, double now) { row[i] = counts ? now : row[i]; };
        keep(c.force, shear.force), keep(c.energy, shear.energy), keep(c.slip, shear.slip), keep(c.slip_sum, shear.slip_sum);
        keep(c.dilation, shear.dilation), keep(c.slipped, shear.slipped), keep(c.nx, p.nx), keep(c.ny, p.ny);
        keep(c.sliding, r.sliding ? 1.0 : 0.0), keep(c.length, p.length), keep(c.overlap, p.overlap - shear.dilation);
        keep(c.normal_force, r.normal_force), keep(c.strength, r.strength), keep(c.x, position_x[i] + p.x),
            keep(c.y, position_y[i] + p.y);
        fx[i] = r.fx, fy[i] = r.fy, torque_a[i] = r.torque_a, torque_b[i] = r.torque_b;
        friction[i] = r.friction, damping[i] = r.damping, released[i] = r.released;
    }
};

/// Slip has thickened a joint that dilates: the same as moving b against a by -this. The force acts at the true place, so
/// that torques still balance.
[[gnu::always_inline]] inline Vector thicker(const ContactColumns& q, int i) {
    return {q.dilation[i] * q.nx[i], q.dilation[i] * q.ny[i]};
}

}  // namespace talus
