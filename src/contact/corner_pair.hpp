// Two corners that have gone into each other, as diagonal neighbours do wherever two joints cross: the distance potential in
// closed form. Without branches: the same lines serve one pair (update_contacts.cpp) and many (corner_batch.cpp).
#pragma once

#include "contact/pressed.hpp"

#include <algorithm>
#include <cmath>

namespace talus {

/// Corner a of part A and corner b of part B, with the outward normals of the edges that end (1) and start (2) there.
struct CornerLines {
    double ax, ay, na1x, na1y, na2x, na2y;  // m, from the centroid of the block of A
    double bx, by, nb1x, nb1y, nb2x, nb2y;  // m, from that of B
    double dx, dy;                          // m, where b lies from a
    double reach;                           // m, half of how near the other edges of either part come to its corner
    double touch_depth;                     // m, see touch_depth()
};

struct CornerPair {
    Pressed pressed;
    bool valid;  // the overlap is a quadrangle between these two corners, and no face contact in the making
};

/// Int over one edge of the overlap, from the corner where it starts to where it leaves: depth in the other part, the lesser
/// of two lines p + q s (all p > 0).
struct CornerEdge {
    double length, depth, moment;  // m, m2, m3: Int ds, Int f ds, Int s f ds

    [[gnu::always_inline]] CornerEdge(double p1, double q1, double p2, double q2) {
        // An edge that never comes out has a length beyond every reach.
        const double never = 1e300;
        length = std::min(q1 < 0.0 ? -p1 / q1 : never, q2 < 0.0 ? -p2 / q2 : never);
        const double cross = (p2 - p1) / (q1 - q2);
        const double middle = cross > 0.0 ? std::min(cross, length) : 0.0;  // also if there is none: not a number
        const double rest = length - middle;
        const double f0 = std::min(p1, p2);
        const double fm = std::max(std::min(p1 + q1 * middle, p2 + q2 * middle), 0.0);
        const double f1 = std::max(std::min(p1 + q1 * length, p2 + q2 * length), 0.0);
        const double first = 0.5 * middle * (f0 + fm), second = 0.5 * rest * (fm + f1);
        depth = first + second;
        moment =
            middle * middle * (f0 + 2.0 * fm) * (1.0 / 6.0) + middle * second + rest * rest * (fm + 2.0 * f1) * (1.0 / 6.0);
    }
};

[[gnu::always_inline]] inline CornerPair corner_pair(const CornerLines& f) {
    const double x = f.bx + f.dx - f.ax, y = f.by + f.dy - f.ay;  // from corner a to corner b
    // Depth of each corner below the edges of the other.
    const double b_in_a1 = -(f.na1x * x + f.na1y * y), b_in_a2 = -(f.na2x * x + f.na2y * y);
    const double a_in_b1 = f.nb1x * x + f.nb1y * y, a_in_b2 = f.nb2x * x + f.nb2y * y;
    // Away from its corner the edge that ends there runs along -perp(normal), the one that starts there along perp(normal).
    const double a1x = f.na1y, a1y = -f.na1x, a2x = -f.na2y, a2y = f.na2x;
    const double b1x = f.nb1y, b1y = -f.nb1x, b2x = -f.nb2y, b2y = f.nb2x;
    const double a1_b1 = f.na1x * b1x + f.na1y * b1y, a1_b2 = f.na1x * b2x + f.na1y * b2y;
    const double a2_b1 = f.na2x * b1x + f.na2y * b1y, a2_b2 = f.na2x * b2x + f.na2y * b2y;
    const double b1_a1 = f.nb1x * a1x + f.nb1y * a1y, b1_a2 = f.nb1x * a2x + f.nb1y * a2y;
    const double b2_a1 = f.nb2x * a1x + f.nb2y * a1y, b2_a2 = f.nb2x * a2x + f.nb2y * a2y;
    const CornerEdge b1(b_in_a1, -a1_b1, b_in_a2, -a2_b1), b2(b_in_a1, -a1_b2, b_in_a2, -a2_b2);
    const CornerEdge a1(a_in_b1, -b1_a1, a_in_b2, -b2_a1), a2(a_in_b1, -b1_a2, a_in_b2, -b2_a2);

    CornerPair pair;
    const double least = std::min(std::min(b_in_a1, b_in_a2), std::min(a_in_b1, a_in_b2));
    const double longest = std::max(std::max(a1.length, a2.length), std::max(b1.length, b2.length));
    // Opposite edges that overlap over 16 times the depth are a face (face::slender).
    const auto flat = [&](double nax, double nay, double nbx, double nby) {
        const double across = std::abs(nax * x + nay * y), along = std::abs(nax * y - nay * x);
        return (nax * nbx + nay * nby < -0.9998) & (along > 15.5 * across);
    };
    const bool face = flat(f.na1x, f.na1y, f.nb1x, f.nb1y) | flat(f.na1x, f.na1y, f.nb2x, f.nb2y) |
                      flat(f.na2x, f.na2y, f.nb1x, f.nb1y) | flat(f.na2x, f.na2y, f.nb2x, f.nb2y);

    // Each edge carries half of its integral: edges of b push b along -n, those of a push b along n.
    Pressed& p = pair.pressed;
    const double weight = a1.depth + a2.depth + b1.depth + b2.depth;
    p.fx = 0.5 * (f.na1x * a1.depth + f.na2x * a2.depth - f.nb1x * b1.depth - f.nb2x * b2.depth);
    p.fy = 0.5 * (f.na1y * a1.depth + f.na2y * a2.depth - f.nb1y * b1.depth - f.nb2y * b2.depth);
    // About corner a; |edge direction x n| is +1 for edges that end at the corner and -1 for those that start there.
    const double turn_a = 0.5 * (a1.moment - a2.moment), turn_b = 0.5 * (b2.moment - b1.moment);
    const double fbx = -0.5 * (f.nb1x * b1.depth + f.nb2x * b2.depth), fby = -0.5 * (f.nb1y * b1.depth + f.nb2y * b2.depth);
    const double about_a = turn_a + turn_b + (x * fby - y * fbx);
    p.torque_a = about_a + (f.ax * p.fy - f.ay * p.fx);
    p.torque_b = about_a + ((f.ax - f.dx) * p.fy - (f.ay - f.dy) * p.fx);
    const double inverse = 1.0 / weight;
    p.x =
        f.ax + inverse * (a1x * a1.moment + a2x * a2.moment + x * (b1.depth + b2.depth) + b1x * b1.moment + b2x * b2.moment);
    p.y =
        f.ay + inverse * (a1y * a1.moment + a2y * a2.moment + y * (b1.depth + b2.depth) + b1y * b1.moment + b2y * b2.moment);
    p.length = 0.5 * (a1.length + a2.length + b1.length + b2.length);
    p.overlap = weight / (2.0 * p.length);
    p.along_normal = std::sqrt(p.fx * p.fx + p.fy * p.fy);
    p.nx = p.fx / p.along_normal;
    p.ny = p.fy / p.along_normal;
    pair.valid = (least > f.touch_depth) & (longest <= f.reach) & (x * x + y * y <= f.reach * f.reach) & !face &
                 (p.along_normal > 0.0);
    return pair;
}

}  // namespace talus
