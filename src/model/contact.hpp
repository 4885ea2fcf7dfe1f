// What is known of two parts that touch, or have touched.
#pragma once

#include "core/types.hpp"

#include <cstdint>

namespace talus {

/// One contact between two convex parts. It exists while it carries force, is bonded, or has memory;
/// see contact/contacts.hpp.
struct Contact {
    PartId part_a, part_b;  // key: block of a < block of b; lists are sorted by (part_a, part_b)
    int joint;
    int face = -1;                 // index into Model::faces, -1 = none
    int edge_a = -1, edge_b = -1;  // edges (global corner index) that face each other, -1 = corner contact
    std::uint8_t touching = 0;     // carries force now
    std::uint8_t slipped = 0;      // has slipped: residual strength
    std::uint8_t sliding = 0;      // slips in this step
    std::uint8_t struck = 0;       // took an impact in this step, so its force says nothing of the next; rigid solver only
    std::uint8_t alive = 0;        // touching, or memory that is still kept; a contact that is not alive is forgotten
    double length = 0.0;           // m, over which it carries force
    double overlap = 0.0;          // m, mean over the length; < 0 open
    double normal_force = 0.0;     // N, compression > 0
    double shear_force = 0.0;      // N on b along perp(normal)
    double shear_energy = 0.0;     // J, stored by the shear force: shear_force^2 / (2 ks x the length that is sheared)
    double strength = 0.0;         // N, shear force it could carry now
    double slip = 0.0;             // m, path slipped so far
    double slip_sum = 0.0;         // m, signed sum: sense of the slip
    double dilation = 0.0;         // m, how far slip has opened it
    double moment = 0.0;           // N m, of the pressure about the middle of the contact; kept by the rigid solver only
    Vec2 point = Vec2::Zero();     // m, centre of pressure
    Vec2 normal = Vec2::Zero();    // unit, from a to b
};

}  // namespace talus
