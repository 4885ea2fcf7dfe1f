// How the force of a contact changes with the places of its two blocks: what Newton's method needs.
#pragma once

#include "model/model.hpp"
#include "model/placed.hpp"
#include "model/state.hpp"

#include <Eigen/Core>

#include <span>

namespace talus {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// -d(forces)/d(places) of one loaded contact: rows are the forces on its two blocks (x, y, torque of a, then of b; N, N m),
/// columns their places (x, y, angle; m, rad).
struct Tangent {
    Matrix6 stiffness = Matrix6::Zero();
    bool symmetric = true;  // but for 1e-4 of it
};

enum class Shear {
    by_the_law,
    sticks,  // wherever there is any strength: the stiffest that a contact can be, and symmetric
};

/// The normal part is a spring kn per length of every loaded stretch; an end that opens adds nothing at first order. The
/// shear part is that of the next step of the law: elastic where the contact sticks, with the normal force where it slides
/// (and with the lift of a joint that dilates); in both cases it falls with the loaded length where an end opens and the
/// contact is sheared evenly. Forces turn with the faces. Left out are terms of the order overlap / length: the thrust of
/// side edges, and corners that slide along. `broken` are the bond cells.
Tangent contact_tangent(const Model& model, const Placed& placed, std::span<const std::uint8_t> broken,
                        const Contact& contact, const Reaction& reaction, Shear shear = Shear::by_the_law);

}  // namespace talus
