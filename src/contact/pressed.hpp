// What two parts that overlap do to each other before friction.
#pragma once

#include "core/types.hpp"

#include <vector>

namespace talus {

/// Normal part of a loaded contact, per unit of joint stiffness where the name says so. Positions and torques are taken from
/// the centroid of block a.
struct Pressed {
    double fx = 0.0, fy = 0.0;        // m2 (times kn: N), force on b
    double torque_a = 0.0;            // m3, of the force on b about the centroid of a (block a gets the opposite)
    double torque_b = 0.0;            // m3, of the force on b about the centroid of b
    double x = 0.0, y = 0.0;          // m, centre of pressure
    double length = 0.0;              // m, loaded
    double bonded_length = 0.0;       // m, of intact bond cells within
    double overlap = 0.0;             // m, mean over the length; < 0 open
    double along_normal = 0.0;        // m2 (times kn: N), > 0 pressed
    double nx = 0.0, ny = 0.0;        // unit, from a to b
    double rotation_stiffness = 0.0;  // m3, Int (s - centre)^2 ds over the loaded length, for the dashpot

    bool loaded() const { return length > 0.0; }
};

/// How the normal part answers to a small displacement of b against a: each spring adds -kn length (measure . displacement
/// at `at`) `force` to the force on b there. Positions from the centroid of block a.
struct PressedSpring {
    double length;        // m
    Vec2 at;              // m
    Vec2 force, measure;  // units; equal for faces
};
/// Where the loaded length ends because the faces part: it grows by `per_closure` for each metre that they close there.
struct OpenEnd {
    Vec2 at;             // m
    double per_closure;  // 1
};
struct PressedSprings {
    std::vector<PressedSpring> springs;
    std::vector<OpenEnd> ends;
};

}  // namespace talus
