// The law of a joint: Mohr-Coulomb with peak and residual strength, on the resultants of one contact.
#pragma once

#include "model/model.hpp"
#include "model/state.hpp"

#include <algorithm>
#include <cmath>

namespace talus {

struct ShearStep {
    double normal_force;   // N, compression > 0
    double length;         // m, loaded
    double bonded_length;  // m, of intact bond cells
    double face_length;    // m, of the face the contact was built with; 0 = none: no cohesion ever
    double displacement;   // m, of b against a along perp(normal) in this step
    double dashpot;        // N, viscous shear force, counted only while the contact sticks
};

struct ShearResult {
    double dashpot = 0.0;     // N, part of it that acts
    double friction = 0.0;    // J, dissipated by slip
    double released = 0.0;    // J, elastic energy given up because the contact shrank
    bool bonds_fail = false;  // first slip of a joint that weakens: its bonds are gone
};

/// |T| <= c L_bonded + N tan(phi); elastic below with ks x length. A contact that shrinks takes the shear stress of the part
/// that is lost with it, otherwise friction would make energy; a part that is new carries none. What counts is the length
/// that is sheared, T^2 / (2 ks E) with the stored energy E (at most the contact length, by Cauchy-Schwarz): only when the
/// contact becomes shorter than that does T fall. A length that trembles therefore costs nothing, where T x length/old
/// length would bleed shear force at every tremor. Friction work is taken with the mean shear force of the step, so that
/// shear work = stored + dissipated + released exactly.
struct MohrCoulomb {
    ShearResult operator()(const Joint& joint, const ShearStep& step, Contact& c) const {
        ShearResult result;
        const double stiffness = joint.ks * step.length;
        double before = c.shear_force, energy = c.shear_energy;
        const double twice_energy_all = before * before / stiffness;  // if the whole length were sheared evenly
        if (twice_energy_all > 2.0 * energy) {                        // the sheared length no longer fits
            const double share = 2.0 * energy / twice_energy_all;
            before *= share;
            result.released = energy * (1.0 - share);
            energy *= share;
            // What is lost worked through half of this step before it went (mean of both its ends).
            result.friction = -0.5 * (c.shear_force - before) * step.displacement;
        }
        const double trial = before - stiffness * step.displacement;
        double strength = this->strength(joint, step, c.slipped);
        c.sliding = std::abs(trial) > strength;
        if (c.sliding) {
            if (!c.slipped && joint.weakens) {
                result.bonds_fail = step.bonded_length > 0.0;
                ShearStep weak = step;
                weak.bonded_length = 0.0;
                strength = std::min(strength, this->strength(joint, weak, true));
            }
            c.slipped = 1;
            const double sign = trial > 0.0 ? 1.0 : -1.0;
            const double force = sign * strength;
            const double slip = (std::abs(trial) - strength) / stiffness;
            c.slip += slip;
            c.slip_sum -= sign * slip;
            // Slip evens the stress out: a contact that slides is sheared over its whole length.
            const double stored = 0.5 * strength * strength / stiffness;
            const double dilation = joint.tan_dilation * std::min(std::abs(c.slip_sum), joint.dilation_cutoff_slip);
            result.friction += energy - stored - 0.5 * (before + force) * step.displacement;
            result.friction -= step.normal_force * (dilation - c.dilation);  // what lifts the block is not lost
            c.dilation = dilation;
            c.shear_force = force;
            c.shear_energy = stored;
        } else {
            if (std::abs(trial + step.dashpot) <= strength) result.dashpot = step.dashpot;
            c.shear_force = trial;
            c.shear_energy = std::max(energy - 0.5 * (before + trial) * step.displacement, 0.5 * trial * trial / stiffness);
        }
        c.strength = strength;
        c.length = step.length;
        return result;
    }

    static double strength(const Joint& joint, const ShearStep& step, bool slipped) {
        const bool weak = slipped && joint.weakens;
        double cohesion = joint.cohesion * step.bonded_length;
        if (joint.weakens)
            cohesion +=
                joint.cohesion_residual * std::max(std::min(step.length, step.face_length) - step.bonded_length, 0.0);
        const double friction = weak ? joint.tan_friction_residual : joint.tan_friction;
        return std::max(cohesion + step.normal_force * friction, 0.0);
    }
};

}  // namespace talus
