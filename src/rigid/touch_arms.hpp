// Directions, arms and velocities of one touch, for those who find, correct and record touches.
#pragma once

#include "rigid/touches.hpp"

namespace talus::rigid {

/// The end at which friction acts.
inline int nearest(const Manifold& m) { return m.count == 2 && m.gap[1] < m.gap[0] ? 1 : 0; }

/// m/s, at which the gap at an end grows.
inline double normal_velocity(const Touch& c, std::span<const Velocity> v, int end) {
    const Velocity &a = v[c.a], &b = v[c.b];
    return c.nx * (b.x - a.x) + c.ny * (b.y - a.y) + c.arm_b[end] * b.spin - c.arm_a[end] * a.spin;
}

/// m/s, of b along the face, seen from a.
inline double tangent_velocity(const Touch& c, std::span<const Velocity> v) {
    const Velocity &a = v[c.a], &b = v[c.b];
    return c.nx * (b.y - a.y) - c.ny * (b.x - a.x) + c.arm_b[2] * b.spin - c.arm_a[2] * a.spin;
}

struct Ahead {          // of the middle of the step, as both bodies moved before it
    double time = 0.0;  // s
    Velocity a{}, b{};
};

/// Directions and arms of a touch; `from_a`: of the centroid of its block a from that of the body (m).
void set_arms(const Manifold& m, const Vec2& from_a, const Bodies& bodies, const Ahead& ahead, Touch& c);

/// m/s2, of the corner against the face along the normal and perp(normal), while both bodies move on at the velocities `v`
/// they had before the step: those with loads but without contacts may spin as the block never will. A corner
/// goes along an arc: a velocity that has no part along the normal now would lift it off the face or press it in within the
/// step, and one without a part along the face would let it slip. Blocks that turn about a corner are of second order by
/// this.
Vec2 bend(const Manifold& m, const Bodies& bodies, std::span<const Velocity> v, const Vec2& from_a, const Touch& c, int end);

/// Its cohesion counts: it has slipped, or nothing of it is left.
inline bool fits_bond(const Model& model, const Contact& c) { return c.face >= 0 && model.faces[c.face].bonded; }

}  // namespace talus::rigid
