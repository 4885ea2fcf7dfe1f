// Where two faces lie on each other, and what a linear closure between them adds up to. Without branches: the same lines
// serve one face with bonds (face_path.cpp) and many without (face_batch.cpp).
#pragma once

#include "contact/pressed.hpp"

#include <algorithm>
#include <cmath>

namespace talus {

/// Edge a of part A and edge b of part B, from the centroids of their blocks; where b lies from a. The edges run against
/// each other: at the low end (along edge_a) lie corners a0 and b0.
struct FaceLines {
    double a0x, a0y, a1x, a1y, nax, nay;
    double b0x, b0y, b1x, b1y, nbx, nby;
    double dx, dy;
    // 1 if the edge next to the face at that end bounds the block; 0 inside a block, where the face goes on in the next
    // part.
    double a_lo, a_hi, b_lo, b_hi;
};

struct Window {
    double nx, ny, tx, ty;  // normal from a to b, tangent along edge_a
    double lo, hi;          // m, positions along t
    double s_start;         // position along t of the first corner of edge_a
    double mid_lo, mid_hi;  // m, height along n half-way between the faces
    double u_lo, u_hi;      // m, closure
    double gap_lo, gap_hi;  // m, distance between the two corners nearest to each end; > 0 if it is a's corner that lies
                            //    inside the face of b, < 0 if b's lies inside the face of a
    bool valid;             // the faces look at each other and have a stretch in common
    bool simple;            // nearly parallel, and long against the overlap: the corners do not matter
};

namespace face {
constexpr double cos_opposite = 0.99619469809175;  // 5 degrees: beyond, faces no longer lie on each other
constexpr double cos_flat = 0.99984769515639;      // 1 degree: beyond, energies of this and the general form differ too much
constexpr double slender = 16.0;                   // window / overlap: below, cells of the corners in the potential matter
}  // namespace face

[[gnu::always_inline]] inline Window face_window(const FaceLines& f) {
    Window w;
    const double cosine = -(f.nax * f.nbx + f.nay * f.nby);
    const double norm = 1.0 / std::sqrt(2.0 + 2.0 * cosine);  // 1 / |na - nb|
    w.nx = (f.nax - f.nbx) * norm;
    w.ny = (f.nay - f.nby) * norm;
    w.tx = -w.ny;
    w.ty = w.nx;
    const double sa0 = w.tx * f.a0x + w.ty * f.a0y, sa1 = w.tx * f.a1x + w.ty * f.a1y;
    const double sd = w.tx * f.dx + w.ty * f.dy, yd = w.nx * f.dx + w.ny * f.dy;
    const double sb0 = w.tx * f.b0x + w.ty * f.b0y + sd, sb1 = w.tx * f.b1x + w.ty * f.b1y + sd;
    w.lo = std::max(sa0, sb0);
    w.hi = std::min(sa1, sb1);
    w.s_start = sa0;
    // Heights of both lines change along t by +-tan of half the angle between the faces; 2 norm = 1 / cos of it.
    const double slope_a = -2.0 * norm * (f.nax * w.tx + f.nay * w.ty), slope_b = -slope_a;
    const double ya = w.nx * f.a0x + w.ny * f.a0y - slope_a * sa0;
    const double yb = w.nx * f.b0x + w.ny * f.b0y + yd - slope_b * sb0;
    const double a_lo = ya + slope_a * w.lo, a_hi = ya + slope_a * w.hi;
    const double b_lo = yb + slope_b * w.lo, b_hi = yb + slope_b * w.hi;
    w.u_lo = a_lo - b_lo;
    w.u_hi = a_hi - b_hi;
    w.mid_lo = 0.5 * (a_lo + b_lo);
    w.mid_hi = 0.5 * (a_hi + b_hi);
    const double gap_lo = sa0 - sb0, gap_hi = sb1 - sa1;
    w.gap_lo = gap_lo * (gap_lo > 0.0 ? f.a_lo : f.b_lo);
    w.gap_hi = gap_hi * (gap_hi > 0.0 ? f.a_hi : f.b_hi);
    w.valid = (cosine >= face::cos_opposite) & (w.lo < w.hi);
    w.simple = (cosine >= face::cos_flat) & (face::slender * std::max(w.u_lo, w.u_hi) < w.hi - w.lo);
    return w;
}

/// Closure a joint face was built with, m: initial normal stress / kn at the positions s0 and s1 along edge_a, linear
/// between, constant beyond.
struct InitialClosure {
    double s0 = 0.0, s1 = 1.0, at_s0 = 0.0, at_s1 = 0.0;

    [[gnu::always_inline]] double slope() const { return (at_s1 - at_s0) / (s1 - s0); }
    [[gnu::always_inline]] double operator()(double s) const {
        return at_s0 + slope() * (std::min(std::max(s, s0), s1) - s0);
    }
};

struct Closure {  // geometric + initial, at the ends of a window
    double lo, hi, initial_lo, initial_hi;
};

[[gnu::always_inline]] inline Closure closure_of(const Window& w, const InitialClosure& initial) {
    const double lo = initial(w.lo - w.s_start), hi = initial(w.hi - w.s_start);
    return {w.u_lo + lo, w.u_hi + hi, lo, hi};
}

/// Of a linear closure over pieces of the window.
struct FaceIntegral {
    double force = 0.0, moment = 0.0, length = 0.0, first = 0.0, second = 0.0;

    /// Adds the stretch s0..s1 with closures d0..d1.
    [[gnu::always_inline]] void full(double s0, double s1, double d0, double d1) {
        const double l = s1 - s0;
        force += 0.5 * l * (d0 + d1);
        moment += l * (s0 * (2.0 * d0 + d1) + s1 * (d0 + 2.0 * d1)) * (1.0 / 6.0);
        length += l;
        first += 0.5 * l * (s0 + s1);
        second += l * (s0 * s0 + s0 * s1 + s1 * s1) * (1.0 / 3.0);
    }
    /// Adds the part of it where the closure is > 0; at one end at least it must be.
    [[gnu::always_inline]] void positive(double s0, double s1, double d0, double d1) {
        const double per_closure = (s1 - s0) / (std::abs(d0) + std::abs(d1));
        full(s0 + per_closure * std::max(-d0, 0.0), s1 - per_closure * std::max(-d1, 0.0), std::max(d0, 0.0),
             std::max(d1, 0.0));
    }
};

/// Thrust of the side edges at one end, over kn: positive when it points away from the window for the force on b. It fades
/// out where the corners of both blocks coincide, as the potential does (their side edges then bound the overlap together).
[[gnu::always_inline]] inline double end_thrust(double u, double initial, bool bonded, double corner_gap) {
    const double closed = bonded ? u + initial : std::max(u + initial, 0.0);
    const double ratio = std::min(std::abs(corner_gap) / std::max(std::abs(u), 1e-300), 1.0);
    const double share = 0.25 * (closed * closed - initial * initial) * ratio * (2.0 - ratio);
    return corner_gap > 0.0 ? share : -share;  // a's corner: pushes b outwards; b's corner: pushes b inwards
}

/// The resultant of a loaded face.
[[gnu::always_inline]] inline Pressed pressed_face(const FaceLines& f, const Window& w, const Closure& c,
                                                   const FaceIntegral& sum, double bonded_length, bool bond_lo,
                                                   bool bond_hi) {
    Pressed p;
    p.length = sum.length;
    p.bonded_length = bonded_length;
    p.overlap = 0.5 * (w.u_lo + w.u_hi);
    const double middle = sum.first / sum.length;
    p.rotation_stiffness = std::max(sum.second - sum.first * middle, 0.0);
    // A pair of forces without resultant (half pressed, half pulled) has no centre of pressure: keep the middle for the
    // place and the moment as it is.
    const double quotient = sum.moment / sum.force;
    const double centre = sum.force > 0.0 ? std::min(std::max(quotient, w.lo), w.hi) : middle;
    const double height = w.mid_lo + (w.mid_hi - w.mid_lo) * ((centre - w.lo) / (w.hi - w.lo));
    const double thrust =
        end_thrust(w.u_hi, c.initial_hi, bond_hi, w.gap_hi) - end_thrust(w.u_lo, c.initial_lo, bond_lo, w.gap_lo);
    p.fx = sum.force * w.nx + thrust * w.tx;
    p.fy = sum.force * w.ny + thrust * w.ty;
    p.x = centre * w.tx + height * w.nx;
    p.y = centre * w.ty + height * w.ny;
    // n x t = +1: pressure along n at position s turns by -s, thrust along t at height y by +y.
    const double sd = w.tx * f.dx + w.ty * f.dy, yd = w.nx * f.dx + w.ny * f.dy;
    p.torque_a = height * thrust - sum.moment;
    p.torque_b = (height - yd) * thrust - (sum.moment - sd * sum.force);
    // The normal is that of the force. That of a bond, pressed here and pulled there, may have any direction and trembles
    // where hardly any is left, and with every turn the joint would give up shear force: there it is that of the faces.
    const double along = p.fx * w.nx + p.fy * w.ny, size = std::sqrt(p.fx * p.fx + p.fy * p.fy);
    const bool resultant = (std::abs(along) > 0.9 * size) & (size > 0.0) & (bonded_length == 0.0);
    p.along_normal = resultant ? (along > 0.0 ? size : -size) : along;
    const double inverse = 1.0 / p.along_normal;
    p.nx = resultant ? p.fx * inverse : w.nx;
    p.ny = resultant ? p.fy * inverse : w.ny;
    return p;
}

}  // namespace talus
