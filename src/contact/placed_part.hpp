// A convex part as the contact geometry sees it: turned corners, edge normals and edge offsets, from its block's centroid.
#pragma once

#include "model/model.hpp"
#include "model/placed.hpp"

namespace talus {

struct PlacedPart {
    const Vec2* arm;               // [n] m
    const Vec2* normal;            // [n]
    const double* offset;          // [n] m
    const double* length;          // [n] m
    const std::uint8_t* internal;  // [n]
    int n;
    int first;  // global index of corner 0

    PlacedPart(const Model& model, const Placed& placed, PartId part)
        : arm(&placed.arm[model.parts.first_corner[part]]),
          normal(&placed.normal[model.parts.first_corner[part]]),
          offset(&model.corners.offset[model.parts.first_corner[part]]),
          length(&model.corners.length[model.parts.first_corner[part]]),
          internal(&model.corners.internal[model.parts.first_corner[part]]),
          n(model.parts.first_corner[part + 1] - model.parts.first_corner[part]),
          first(model.parts.first_corner[part]) {}

    int next(int k) const { return k + 1 == n ? 0 : k + 1; }
    int previous(int k) const { return k == 0 ? n - 1 : k - 1; }
};

/// What two parts that overlap do to each other before friction: the normal part of a contact, per unit of joint stiffness
/// where the name says so. Positions and torques are taken from the centroid of block a.
struct Patch {
    double fx = 0.0, fy = 0.0;   // N/(Pa/m) = m2 (times kn: force on b)
    double torque_a = 0.0;       // m3, of the force on b about the centroid of a (block a gets the opposite)
    double torque_b = 0.0;       // m3, of the force on b about the centroid of b
    double x = 0.0, y = 0.0;     // m, centre of pressure
    double length = 0.0;         // m, loaded length
    double bonded_length = 0.0;  // m, of intact bond cells within
    double overlap = 0.0;        // m, mean over the length; < 0 open
    bool loaded = false;
};

}  // namespace talus
