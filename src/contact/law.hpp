// The law of a joint: Mohr-Coulomb with peak and residual strength, on the resultants of one contact. Written without
// branches, so that the compiler can make one or many contacts of it.
#pragma once

#include "model/model.hpp"

#include <algorithm>
#include <cmath>

namespace talus {

struct ShearStep {
    double normal_force;   // N, compression > 0, with the dashpot
    double length;         // m, loaded
    double bonded_length;  // m, of intact bond cells
    double face_length;    // m, of the face the contact was built with; 0 = none: no cohesion ever
    double displacement;   // m, of b against a along perp(normal) in this step
    double dashpot;        // N, viscous shear force, counted only while the contact sticks
    double elastic = 0.0;  // N, normal force without its dashpot
    double opening = 0.0;  // m, of b from a along the normal in this step
};

/// What a contact knows about its shear; the members of the same names in Contact.
struct ShearMemory {
    double force = 0.0, energy = 0.0, slip = 0.0, slip_sum = 0.0, dilation = 0.0;
    double slipped = 0.0;  // 1 = has slipped
};

struct ShearResult {
    double strength = 0.0;  // N, the shear force it could carry
    double dashpot = 0.0;   // N, part of it that acts
    double friction = 0.0;  // J, dissipated by slip
    double released = 0.0;  // J, elastic energy given up because the contact shrank
    double lift = 0.0;      // m, by which slip has thickened the joint
    bool sliding = false;
    bool bonds_fail = false;  // first slip of a joint that weakens: its bonds are gone
};

/// max(x, 0), exact; as a sum because a comparison that others hang on keeps compilers from making vectors.
[[gnu::always_inline]] inline double positive_part(double x) { return 0.5 * (x + std::abs(x)); }

[[gnu::always_inline]] inline double shear_strength(const JointLaw& joint, double normal_force, double length,
                                                    double bonded_length, double face_length, double tan_friction) {
    const double rest = positive_part(std::min(length, face_length) - bonded_length);
    const double cohesion = joint.cohesion * bonded_length + (joint.weakens ? joint.cohesion_residual * rest : 0.0);
    return positive_part(cohesion + normal_force * tan_friction);
}

/// |T| <= c L_bonded + N tan(phi); elastic below with ks x length. A contact that shrinks takes the shear stress of the part
/// that is lost with it, otherwise friction would make energy; a part that is new carries none. What counts is the length
/// that is sheared, T^2 / (2 ks E) with the stored energy E (at most the contact length, by Cauchy-Schwarz): only when the
/// contact becomes shorter than that does T fall. A length that trembles therefore costs nothing, where T x length/old
/// length would bleed shear force at every tremor.
///
/// Slip on a dilating joint lifts it by tan(psi) per metre (lowers it on the way back), which presses it with kn x length in
/// the same step: the slip is taken against ks and this stiffness together. Taken against ks alone, the normal force lags
/// behind by one step and slip back is unstable. Friction work is taken with the mean shear force of the step, so that
/// shear work = stored + dissipated + released exactly.
[[gnu::always_inline]] inline ShearResult mohr_coulomb(const JointLaw& joint, const ShearStep& step, ShearMemory& c) {
    ShearResult result;
    const double stiffness = joint.ks * step.length, softness = 1.0 / stiffness;
    const double energy_if_even = 0.5 * c.force * c.force * softness;  // sheared over the whole length
    const double share = energy_if_even > c.energy ? c.energy / energy_if_even : 1.0;
    const double before = c.force * share, energy = c.energy * share;
    result.released = c.energy * (1.0 - share);
    // What is lost worked through half of this step before it went (mean of both its ends).
    const double lost_work = -0.5 * (c.force - before) * step.displacement;

    const double trial = before - stiffness * step.displacement, size = std::abs(trial);
    const double residual_friction = joint.tan_friction_residual;
    const bool slipped = c.slipped != 0.0;
    const double friction = slipped & joint.weakens ? residual_friction : joint.tan_friction;
    const double peak =
        shear_strength(joint, step.normal_force, step.length, step.bonded_length, step.face_length, friction);
    result.sliding = size > peak;
    const bool weakens_now = result.sliding & !slipped & joint.weakens;
    const double residual = shear_strength(joint, step.normal_force, step.length, 0.0, step.face_length, residual_friction);
    result.strength = weakens_now ? std::min(peak, residual) : peak;
    result.bonds_fail = weakens_now & (step.bonded_length > 0.0);

    // If it slides:
    const double sign = trial > 0.0 ? 1.0 : -1.0;
    const double tangent = std::abs(c.slip_sum) < joint.dilation_cutoff_slip ? joint.tan_dilation : 0.0;
    const double per_slip = sign * c.slip_sum > 0.0 ? -tangent : tangent;  // dilation grows away from the start only
    const double strengthening = (weakens_now ? residual_friction : friction) * joint.kn * step.length * per_slip;
    const double stiffening = std::max(strengthening, -0.9 * stiffness);  // beyond, the joint would run away by itself
    const double slip = std::min((size - result.strength) / (stiffness + stiffening), size * softness);
    const double slid_force = sign * positive_part(result.strength + stiffening * slip);
    const double slip_sum = c.slip_sum - sign * slip;
    const double dilation = joint.tan_dilation * std::min(std::abs(slip_sum), joint.dilation_cutoff_slip);
    const double lift = dilation - c.dilation;
    // Slip evens the stress out: a contact that slides is sheared over its whole length. What lifts the block is not lost.
    const double slid_energy = 0.5 * slid_force * slid_force * softness;
    const double slid_work = energy - slid_energy - 0.5 * (before + slid_force) * step.displacement -
                             lift * (step.elastic + 0.5 * joint.kn * step.length * (lift + step.opening));
    // If it sticks:
    const double held_energy = std::max(energy - 0.5 * (before + trial) * step.displacement, 0.5 * trial * trial * softness);
    const double held_dashpot = std::abs(trial + step.dashpot) <= result.strength ? step.dashpot : 0.0;

    result.friction = lost_work + (result.sliding ? slid_work : 0.0);
    result.lift = result.sliding ? lift : 0.0;
    result.dashpot = result.sliding ? 0.0 : held_dashpot;
    c.force = result.sliding ? slid_force : trial;
    c.energy = result.sliding ? slid_energy : held_energy;
    c.slip += result.sliding ? slip : 0.0;
    c.slip_sum = result.sliding ? slip_sum : c.slip_sum;
    c.dilation = result.sliding ? dilation : c.dilation;
    c.slipped = result.sliding ? 1.0 : c.slipped;
    return result;
}

}  // namespace talus
