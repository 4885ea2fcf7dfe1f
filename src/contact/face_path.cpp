#include "contact/face_path.hpp"

#include <algorithm>

namespace talus {
namespace {

// Walks over the stretches of the window: all of it, or with bonds what lies outside the joint face and cell by cell inside.
// visit(s0, s1, d0, d1, cell) gets positions along t, closures (geometric + initial), and the cell or -1.
template <class Visit>
void walk(const Window& w, const Closure& closure, const FaceMemory* memory, Visit&& visit) {
    if (!memory || !memory->broken) {
        visit(w.lo, w.hi, closure.lo, closure.hi, -1);
        return;
    }
    const InitialClosure& initial = memory->initial;
    const double slope = (w.u_hi - w.u_lo) / (w.hi - w.lo);
    const auto at = [&](double s) { return w.u_lo + slope * (s - w.lo) + initial(s - w.s_start); };
    const double face0 = std::max(w.lo, w.s_start + initial.s0), face1 = std::min(w.hi, w.s_start + initial.s1);
    if (!(face0 < face1)) {
        visit(w.lo, w.hi, closure.lo, closure.hi, -1);
        return;
    }
    if (w.lo < face0) visit(w.lo, face0, closure.lo, at(face0), -1);
    double s = face0;
    for (int i = 0; i < memory->cells; ++i) {
        const double end =
            i + 1 == memory->cells
                ? face1
                : std::clamp(w.s_start + initial.s0 + (initial.s1 - initial.s0) * (i + 1) / memory->cells, s, face1);
        if (s < end) visit(s, end, at(s), at(end), i);
        s = end;
    }
    if (face1 < w.hi) visit(face1, w.hi, at(face1), closure.hi, -1);
}

InitialClosure initial_of(const FaceMemory* memory) { return memory ? memory->initial : InitialClosure{}; }

}  // namespace

FaceContact face_contact(const PlacedPart& a, const PlacedPart& b, double dx, double dy, int ea, int eb,
                         const FaceMemory* memory) {
    FaceContact contact;
    const FaceLines lines = face_lines(a, b, dx, dy, ea, eb);
    const Window w = face_window(lines);
    if (!w.valid || !(w.simple || memory)) return contact;
    const Closure closure = closure_of(w, initial_of(memory));
    FaceIntegral sum;
    double bonded_length = 0.0;
    bool bond_lo = false, bond_hi = false;
    walk(w, closure, memory, [&](double s0, double s1, double d0, double d1, int cell) {
        if (cell >= 0 && !memory->broken[cell]) {
            sum.full(s0, s1, d0, d1);
            bonded_length += s1 - s0;
            contact.largest_pull = std::max(contact.largest_pull, -std::min(d0, d1));
            bond_lo |= s0 == w.lo;
            bond_hi |= s1 == w.hi;
        } else if (d0 > 0.0 || d1 > 0.0) {
            sum.positive(s0, s1, d0, d1);
        }
    });
    contact.state = sum.length > 0.0 ? FaceState::loaded : FaceState::open;
    if (sum.length > 0.0) contact.pressed = pressed_face(lines, w, closure, sum, bonded_length, bond_lo, bond_hi);
    return contact;
}

void face_springs(const PlacedPart& a, const PlacedPart& b, double dx, double dy, int ea, int eb, const FaceMemory* memory,
                  PressedSprings& found) {
    const Window w = face_window(face_lines(a, b, dx, dy, ea, eb));
    if (!w.valid) return;
    const Vec2 n(w.nx, w.ny), t(w.tx, w.ty);
    const auto place = [&](double s) {
        return Vec2(s * t + (w.mid_lo + (w.mid_hi - w.mid_lo) * ((s - w.lo) / (w.hi - w.lo))) * n);
    };
    walk(w, closure_of(w, initial_of(memory)), memory, [&](double s0, double s1, double d0, double d1, int cell) {
        if (cell < 0 || memory->broken[cell]) {
            if (d0 <= 0.0 && d1 <= 0.0) return;
            const double per_closure = (s1 - s0) / std::max(std::abs(d1 - d0), 1e-300);
            const double zero = s0 + per_closure * std::abs(d0);
            if (d0 < 0.0) s0 = zero, found.ends.push_back({place(zero), per_closure});
            if (d1 < 0.0) s1 = zero, found.ends.push_back({place(zero), per_closure});
        }
        for (const double gauss : {-0.5, 0.5})  // two points integrate what is linear times linear
            found.springs.push_back({0.5 * (s1 - s0), place(0.5 * (s0 + s1) + (s1 - s0) * gauss / std::sqrt(3.0)), n, n});
    });
}

double face_energy(const PlacedPart& a, const PlacedPart& b, double dx, double dy, int ea, int eb,
                   const FaceMemory* memory) {
    const Window w = face_window(face_lines(a, b, dx, dy, ea, eb));
    if (!w.valid) return 0.0;
    double energy = 0.0;
    walk(w, closure_of(w, initial_of(memory)), memory, [&](double s0, double s1, double d0, double d1, int cell) {
        if (cell < 0 || memory->broken[cell]) {
            if (d0 <= 0.0 && d1 <= 0.0) return;
            if (d0 < 0.0) s0 += (s1 - s0) * (d0 / (d0 - d1)), d0 = 0.0;
            if (d1 < 0.0) s1 -= (s1 - s0) * (d1 / (d1 - d0)), d1 = 0.0;
        }
        energy += (s1 - s0) * (d0 * d0 + d0 * d1 + d1 * d1) / 6.0;
    });
    return energy;
}

int break_cells(const PlacedPart& a, const PlacedPart& b, double dx, double dy, int ea, int eb, const FaceMemory& memory,
                double strength, std::uint8_t* broken) {
    const Window w = face_window(face_lines(a, b, dx, dy, ea, eb));
    if (!w.valid) return 0;
    int count = 0;
    walk(w, closure_of(w, memory.initial), &memory, [&](double, double, double d0, double d1, int cell) {
        if (cell < 0 || broken[cell] || -std::min(d0, d1) <= strength) return;
        broken[cell] = 1;
        ++count;
    });
    return count;
}

}  // namespace talus
