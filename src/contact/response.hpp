// From the geometry of a loaded contact to the forces on its two blocks: relative velocity, dashpots, shear. Without
// branches, like the law it uses.
#pragma once

#include "contact/law.hpp"
#include "contact/pressed.hpp"

namespace talus {

/// Velocities over the half step before now, m/s and rad/s; where b lies from a, m.
struct Approach {
    double vax, vay, spin_a, vbx, vby, spin_b;
    double dx, dy;
};

struct Response {
    double fx, fy;                       // N on b; a gets the opposite
    double torque_a, torque_b;           // N m, on each block about its centroid
    double normal_force;                 // N, with the dashpot
    double strength;                     // N, shear force it could carry
    double friction, damping, released;  // J in this step
    bool sliding, bonds_fail;
};

struct Vector {
    double x, y;
};

/// m/s, of b against a at the point `at` from the centroid of a, over the step that has just ended. The last terms take the
/// arms back to the middle of the step, or two blocks that turn together would seem to slip (by spin^2 dt/2 x distance).
[[gnu::always_inline]] inline Vector relative_velocity(const Approach& m, double x, double y, double dt) {
    const double bx = x - m.dx, by = y - m.dy;
    const double back_a = 0.5 * dt * m.spin_a * m.spin_a, back_b = 0.5 * dt * m.spin_b * m.spin_b;
    return {(m.vbx - m.spin_b * by + back_b * bx) - (m.vax - m.spin_a * y + back_a * x),
            (m.vby + m.spin_b * bx + back_b * by) - (m.vay + m.spin_a * x + back_a * y)};
}

/// Moves the shear of the contact over a step dt (0: forces only) and gives the forces. `before` is the normal of the step
/// before, `damping` the stiffness-proportional damping in s, `face_length` that of the face the contact was built with.
[[gnu::always_inline]] inline Response respond(const JointLaw& joint, const Pressed& p, const Approach& m, double dt,
                                               double damping, double face_length, const Vector& before, ShearMemory& c) {
    const double tx = -p.ny, ty = p.nx;
    const double bx = p.x - m.dx, by = p.y - m.dy;
    const Vector v = relative_velocity(m, p.x, p.y, dt);
    const double vn = v.x * p.nx + v.y * p.ny, vt = v.x * tx + v.y * ty, turning = m.spin_b - m.spin_a;

    // A contact that has moved to other edges keeps the part of its shear force that lies in the new plane.
    const double turned = before.x * p.nx + before.y * p.ny;
    const double kept = turned < 0.9999 ? std::max(turned, 0.0) : 1.0;
    const double given_up = c.energy * (1.0 - kept * kept);
    c.force *= kept;
    c.energy *= kept * kept;

    const double elastic = joint.kn * p.along_normal;
    const double viscous = -damping * joint.kn * p.length * vn;
    // A plain contact cannot pull.
    const double normal_dashpot = p.bonded_length == 0.0 ? std::max(viscous, -elastic) : viscous;
    const double moment_dashpot = -damping * joint.kn * p.rotation_stiffness * turning;
    Response r;
    r.normal_force = elastic + normal_dashpot;
    const ShearStep step{r.normal_force, p.length, p.bonded_length,
                         face_length,    vt * dt,  -damping * joint.ks * p.length * vt,
                         elastic,        vn * dt};
    const ShearResult shear = mohr_coulomb(joint, step, c);
    const double t = c.force + shear.dashpot;
    const double lifted = joint.kn * p.length * shear.lift;
    const double lifting = p.bonded_length == 0.0 ? std::max(lifted, -r.normal_force) : lifted;
    const double other_n = normal_dashpot + lifting;
    r.normal_force += lifting;
    const double other_x = other_n * p.nx + t * tx, other_y = other_n * p.ny + t * ty;
    r.fx = joint.kn * p.fx + other_x;
    r.fy = joint.kn * p.fy + other_y;
    r.torque_a = -(joint.kn * p.torque_a + (p.x * other_y - p.y * other_x) + moment_dashpot);
    r.torque_b = joint.kn * p.torque_b + (bx * other_y - by * other_x) + moment_dashpot;
    r.strength = std::max(shear.strength, std::abs(c.force));
    r.friction = shear.friction;
    r.damping = -(normal_dashpot * vn + shear.dashpot * vt + moment_dashpot * turning) * dt;
    r.released = shear.released + given_up;
    r.sliding = shear.sliding;
    r.bonds_fail = shear.bonds_fail;
    return r;
}

}  // namespace talus
