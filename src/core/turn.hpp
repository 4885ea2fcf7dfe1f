// Sine and cosine with the same bits on every machine: those of the C library differ between processors, and results with
// them.
#pragma once

#include "core/types.hpp"

namespace talus {

struct Turn {
    double c, s;  // cosine and sine
};

/// Of an angle in rad, |angle| < 1e6, to about one unit in the last place. Without branches, so that a loop over blocks
/// becomes vectors. Reduction by multiples of pi/2 in two parts (Cody and Waite 1980), then the minimax polynomials of
/// FDLIBM (Sun Microsystems 1993), https://netlib.org/fdlibm.
inline Turn turn(double angle) {
    constexpr double to_nearest = 6755399441055744.0;  // 1.5 x 2^52: adding and taking it away rounds to an integer
    constexpr double two_over_pi = 6.36619772367581382433e-01;
    constexpr double half_pi_head = 1.57079632673412561417e+00, half_pi_tail = 6.07710050650619224932e-11;
    const double k = (angle * two_over_pi + to_nearest) - to_nearest;
    const double high = angle - k * half_pi_head, low = k * half_pi_tail;
    const double x = high - low, rest = (high - x) - low, z = x * x;

    const double ps =
        8.33333333332248946124e-03 +
        z * (-1.98412698298579493134e-04 +
             z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
    const double v = z * x;
    const double sine = x - ((z * (0.5 * rest - v * ps) - rest) - v * -1.66666666666666324348e-01);

    const double pc =
        z *
        (4.16666666666666019037e-02 +
         z * (-1.38888888888741095749e-03 +
              z * (2.48015872894767294178e-05 +
                   z * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
    const double half = 0.5 * z, w = 1.0 - half;
    const double cosine = w + (((1.0 - w) - half) + (z * pc - x * rest));

    const double quarter = k - 4.0 * ((0.25 * k + to_nearest) - to_nearest);  // -2, -1, 0, 1 or 2
    const bool odd = quarter * quarter == 1.0;
    const double c = odd ? sine : cosine, s = odd ? cosine : sine;
    const bool back = quarter * quarter == 4.0;
    return {back | (quarter == 1.0) ? -c : c, back | (quarter == -1.0) ? -s : s};
}

inline Vec2 turned(const Vec2& v, const Turn& t) { return {t.c * v.x() - t.s * v.y(), t.s * v.x() + t.c * v.y()}; }
inline Vec2 turned(const Vec2& v, double angle) { return turned(v, turn(angle)); }

}  // namespace talus
