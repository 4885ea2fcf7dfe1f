// A joint observed at a place: between which parts it lies, how they have moved there, what it carries.
#pragma once

#include "model/material_point.hpp"
#include "model/model.hpp"
#include "model/state.hpp"

namespace talus {

struct PlacedJoint {
    PartId part_a, part_b;     // key of its contact, a < b
    MaterialPoint on_a, on_b;  // where it is observed
    Vec2 normal;               // unit, outward from a, unrotated

    /// The contact it has now; nullptr while there is none.
    const Contact* contact(const State& state) const;
    /// m, how far b has moved from a along the normal, and along perp(normal), since the start or the last reset.
    double opening(const State& state) const;
    double shear_displacement(const State& state) const;
};

/// The joint between the part nearest to the place and the nearest part of another block; needs two blocks.
PlacedJoint joint_near(const Model& model, const State& state, const Vec2& place);

/// Pa, largest stress of the linear distribution with the normal force, length and centre of pressure of the contact:
/// N/L (1 + 6 e/L) while the whole face is pressed, 2 N/L when part of it has opened.
double max_normal_stress(const Model& model, const State& state, const Contact& contact);

}  // namespace talus
