// The closed form for two faces that lie on each other: most contacts of a rock mass, at a fraction of the general cost.
#pragma once

#include "contact/face_window.hpp"
#include "contact/placed_part.hpp"

#include <cstdint>

namespace talus {

/// What a joint face brings along besides geometry: the stress it was built with, and bond cells that can pull.
struct FaceMemory {
    InitialClosure initial;
    const std::uint8_t* broken;  // [cells] 0 = intact; null: no bonds
    int cells;
};

enum class FaceState { invalid, open, loaded };

struct FaceContact {
    FaceState state = FaceState::invalid;
    Pressed pressed;
    double largest_pull = 0.0;  // m, over the intact cells: tension / kn at the end where it is largest
};

inline FaceLines face_lines(const PlacedPart& a, const PlacedPart& b, double dx, double dy, int ea, int eb) {
    const int a_next = a.next(ea), b_next = b.next(eb);
    const Vec2 &a0 = a.arm(ea), &a1 = a.arm(a_next), &b1 = b.arm(eb), &b0 = b.arm(b_next);
    const Vec2 &na = a.normal(ea), &nb = b.normal(eb);
    const auto outer = [](const PlacedPart& part, int k) { return part.internal[k] ? 0.0 : 1.0; };
    return {a0.x(),
            a0.y(),
            a1.x(),
            a1.y(),
            na.x(),
            na.y(),
            b0.x(),
            b0.y(),
            b1.x(),
            b1.y(),
            nb.x(),
            nb.y(),
            dx,
            dy,
            outer(a, a.previous(ea)),
            outer(a, a_next),
            outer(b, b_next),
            outer(b, b.previous(eb))};
}

/// Contact along edge ea of A and edge eb of B. `invalid` when the edges are more than 1 degree from anti-parallel (with
/// memory: 5) or when the window in which they face each other is not long against the overlap: then corners matter and the
/// general law must decide (a face with memory ends only by the angle or when the edges no longer face each other). The
/// closure u(s) is linear between the ends of the window; pressure kn u where closed, Winkler moments exact. The force acts
/// along the bisector of the two faces plus, at each end of the window, the thrust (kn/4) u^2 of the side edge whose corner
/// lies there: without it a block tilted by theta would feel a false tangential force N theta / 2. Differs from the general
/// distance potential by O(u / length) in stiffness, and by higher order in direction.
FaceContact face_contact(const PlacedPart& a, const PlacedPart& b, double dx, double dy, int ea, int eb,
                         const FaceMemory* memory);

/// Its derivative, but for terms of the order overlap / length: the thrust, and corners that slide along.
void face_springs(const PlacedPart& a, const PlacedPart& b, double dx, double dy, int ea, int eb, const FaceMemory* memory,
                  PressedSprings& found);

/// E / kn of a loaded face, m3.
double face_energy(const PlacedPart& a, const PlacedPart& b, double dx, double dy, int ea, int eb, const FaceMemory* memory);

/// Breaks the bond cells whose tension at one end exceeds kn x `strength` (m); returns how many broke.
int break_cells(const PlacedPart& a, const PlacedPart& b, double dx, double dy, int ea, int eb, const FaceMemory& memory,
                double strength, std::uint8_t* broken);

}  // namespace talus
