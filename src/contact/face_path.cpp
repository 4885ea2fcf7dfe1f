#include "contact/face_path.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

constexpr double cos_limit =
    0.99619469809;                // 5 degrees: beyond, the thrust of the side edges is no longer a small correction
constexpr double slender = 16.0;  // window / overlap: below, the cells of the corners in the potential matter

struct Window {
    double nx, ny, tx, ty;  // normal from a to b, tangent along edge_a
    double lo, hi;          // m, positions along t
    double s_start;         // position along t of the first corner of edge_a
    double mid_lo, mid_hi;  // m, height along n half-way between the faces
    double u_lo, u_hi;      // m, closure
    double gap_lo, gap_hi;  // m, distance between the two corners nearest to each end; > 0 if it is a's corner that lies
};                          //    inside the face of b, < 0 if b's lies inside the face of a

bool make_window(const PlacedPart& a, const PlacedPart& b, double dx, double dy, int ea, int eb, bool any_depth, Window& w) {
    const Vec2& na = a.normal[ea];
    const Vec2& nb = b.normal[eb];
    const double cosine = -(na.x() * nb.x() + na.y() * nb.y());
    if (cosine < cos_limit) return false;
    const double norm = 1.0 / std::sqrt(2.0 + 2.0 * cosine);  // |na - nb|
    w.nx = (na.x() - nb.x()) * norm;
    w.ny = (na.y() - nb.y()) * norm;
    w.tx = -w.ny;
    w.ty = w.nx;
    const Vec2& a0 = a.arm[ea];
    const Vec2& a1 = a.arm[a.next(ea)];
    const Vec2& b1 = b.arm[eb];  // edges run against each other
    const Vec2& b0 = b.arm[b.next(eb)];
    const double sa0 = w.tx * a0.x() + w.ty * a0.y(), sa1 = w.tx * a1.x() + w.ty * a1.y();
    const double sd = w.tx * dx + w.ty * dy, yd = w.nx * dx + w.ny * dy;
    const double sb0 = w.tx * b0.x() + w.ty * b0.y() + sd, sb1 = w.tx * b1.x() + w.ty * b1.y() + sd;
    w.lo = std::max(sa0, sb0);
    w.hi = std::min(sa1, sb1);
    if (!(w.lo < w.hi)) return false;
    // Heights of both lines: n.x = offset / cos + slope s, with the slope +-tan of half the angle between the faces.
    const double half_cos = na.x() * w.nx + na.y() * w.ny;
    const double slope_a = -(na.x() * w.tx + na.y() * w.ty) / half_cos, slope_b = -slope_a;
    const double ya = w.nx * a0.x() + w.ny * a0.y() - slope_a * sa0;
    const double yb = w.nx * b0.x() + w.ny * b0.y() + yd - slope_b * sb0;
    const double a_lo = ya + slope_a * w.lo, a_hi = ya + slope_a * w.hi;
    const double b_lo = yb + slope_b * w.lo, b_hi = yb + slope_b * w.hi;
    w.u_lo = a_lo - b_lo;
    w.u_hi = a_hi - b_hi;
    w.mid_lo = 0.5 * (a_lo + b_lo);
    w.mid_hi = 0.5 * (a_hi + b_hi);
    w.gap_lo = sa0 - sb0;
    w.gap_hi = sb1 - sa1;
    w.s_start = sa0;
    // An edge inside a block is no side edge: the face goes on in the next part.
    if (w.gap_lo > 0.0 ? a.internal[a.previous(ea)] : b.internal[b.next(eb)]) w.gap_lo = 0.0;
    if (w.gap_hi > 0.0 ? a.internal[a.next(ea)] : b.internal[b.previous(eb)]) w.gap_hi = 0.0;
    return any_depth || slender * std::max(w.u_lo, w.u_hi) < w.hi - w.lo;
}

struct Integral {  // of the linear closure over pieces of the window
    double force = 0.0, moment = 0.0, length = 0.0, first = 0.0, second = 0.0;

    void full(double s0, double s1, double d0, double d1) {
        const double l = s1 - s0;
        force += 0.5 * l * (d0 + d1);
        moment += l * (s0 * (2.0 * d0 + d1) + s1 * (d0 + 2.0 * d1)) / 6.0;
        length += l;
        first += 0.5 * l * (s0 + s1);
        second += l * (s0 * s0 + s0 * s1 + s1 * s1) / 3.0;
    }
    void positive(double s0, double s1, double d0, double d1) {  // only where the closure is > 0
        if (d0 <= 0.0 && d1 <= 0.0) return;
        if (d0 < 0.0) {
            s0 += (s1 - s0) * (d0 / (d0 - d1));
            d0 = 0.0;
        } else if (d1 < 0.0) {
            s1 -= (s1 - s0) * (d1 / (d1 - d0));
            d1 = 0.0;
        }
        full(s0, s1, d0, d1);
    }
};

// Walks over the stretches of the window: outside the joint face, and cell by cell inside. visit(s0, s1, d0, d1, cell) gets
// positions along t, effective closures (geometric + initial), and the cell or -1.
template <class Visit>
void walk(const Window& w, const FaceMemory* memory, Visit&& visit) {
    if (!memory) {
        visit(w.lo, w.hi, w.u_lo, w.u_hi, -1);
        return;
    }
    const double slope = (w.u_hi - w.u_lo) / (w.hi - w.lo);
    const double initial_slope = (memory->closure1 - memory->closure0) / (memory->s1 - memory->s0);
    const auto closure = [&](double s) {
        const double along = std::clamp(s - w.s_start, memory->s0, memory->s1);
        return w.u_lo + slope * (s - w.lo) + memory->closure0 + initial_slope * (along - memory->s0);
    };
    const double face0 = std::max(w.lo, w.s_start + memory->s0), face1 = std::min(w.hi, w.s_start + memory->s1);
    if (!(face0 < face1)) {
        visit(w.lo, w.hi, closure(w.lo), closure(w.hi), -1);
        return;
    }
    if (w.lo < face0) visit(w.lo, face0, closure(w.lo), closure(face0), -1);
    const int pieces = memory->broken ? memory->cells : 1;
    double s = face0;
    for (int i = 0; i < pieces; ++i) {
        const double end = i + 1 == pieces
                               ? face1
                               : std::clamp(w.s_start + memory->s0 + (memory->s1 - memory->s0) * (i + 1) / pieces, s, face1);
        if (s < end) visit(s, end, closure(s), closure(end), memory->broken ? i : -1);
        s = end;
    }
    if (face1 < w.hi) visit(face1, w.hi, closure(face1), closure(w.hi), -1);
}

double initial_closure(const Window& w, const FaceMemory* memory, double s) {
    if (!memory) return 0.0;
    const double along = std::clamp(s - w.s_start, memory->s0, memory->s1);
    return memory->closure0 + (memory->closure1 - memory->closure0) * (along - memory->s0) / (memory->s1 - memory->s0);
}

// Thrust of the side edges at one end, over kn: positive when it points away from the window for the force on b. It fades
// out where the corners of both blocks coincide, as the potential does (their side edges then bound the overlap together).
double end_thrust(double u, double initial, bool bonded, double corner_gap) {
    const double closed = bonded ? u + initial : std::max(u + initial, 0.0);
    const double ratio = std::min(std::abs(corner_gap) / std::max(std::abs(u), 1e-300), 1.0);
    const double share = 0.25 * (closed * closed - initial * initial) * ratio * (2.0 - ratio);
    return corner_gap > 0.0 ? share : -share;  // a's corner: pushes b outwards; b's corner: pushes b inwards
}

}  // namespace

FacePatch face_contact(const PlacedPart& a, const PlacedPart& b, double dx, double dy, int ea, int eb,
                       const FaceMemory* memory) {
    FacePatch patch;
    Window w;
    if (!make_window(a, b, dx, dy, ea, eb, memory != nullptr, w)) return patch;
    patch.nx = w.nx;
    patch.ny = w.ny;
    patch.mean_closure = 0.5 * (w.u_lo + w.u_hi);
    Integral sum;
    bool bond_lo = false, bond_hi = false;
    walk(w, memory, [&](double s0, double s1, double d0, double d1, int cell) {
        if (cell >= 0 && !memory->broken[cell]) {
            sum.full(s0, s1, d0, d1);
            patch.bonded_length += s1 - s0;
            patch.largest_pull = std::max(patch.largest_pull, -std::min(d0, d1));
            bond_lo |= s0 == w.lo;
            bond_hi |= s1 == w.hi;
        } else {
            sum.positive(s0, s1, d0, d1);
        }
    });
    if (sum.length <= 0.0) {
        patch.state = FaceState::open;
        return patch;
    }
    patch.state = FaceState::loaded;
    patch.loaded = true;
    patch.length = sum.length;
    patch.overlap = patch.mean_closure;
    const double middle = sum.first / sum.length;
    patch.rotation_stiffness = std::max(sum.second - sum.first * middle, 0.0);
    // A pair of forces without resultant (half pressed, half pulled) has no centre of pressure: keep the middle for the
    // place and the moment as it is.
    const double centre = sum.force > 0.0 ? std::clamp(sum.moment / sum.force, w.lo, w.hi) : middle;
    const double height = w.mid_lo + (w.mid_hi - w.mid_lo) * (centre - w.lo) / (w.hi - w.lo);
    const double thrust = end_thrust(w.u_hi, initial_closure(w, memory, w.hi), bond_hi, w.gap_hi) -
                          end_thrust(w.u_lo, initial_closure(w, memory, w.lo), bond_lo, w.gap_lo);
    patch.fx = sum.force * w.nx + thrust * w.tx;
    patch.fy = sum.force * w.ny + thrust * w.ty;
    patch.x = centre * w.tx + height * w.nx;
    patch.y = centre * w.ty + height * w.ny;
    // n x t = +1: pressure along n at position s turns by -s, thrust along t at height y by +y.
    const double sd = w.tx * dx + w.ty * dy, yd = w.nx * dx + w.ny * dy;
    patch.torque_a = height * thrust - sum.moment;
    patch.torque_b = (height - yd) * thrust - (sum.moment - sd * sum.force);
    return patch;
}

double face_energy(const PlacedPart& a, const PlacedPart& b, double dx, double dy, int ea, int eb,
                   const FaceMemory* memory) {
    Window w;
    if (!make_window(a, b, dx, dy, ea, eb, memory != nullptr, w)) return 0.0;
    double energy = 0.0;
    walk(w, memory, [&](double s0, double s1, double d0, double d1, int cell) {
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
    Window w;
    if (!make_window(a, b, dx, dy, ea, eb, true, w)) return 0;
    int count = 0;
    walk(w, &memory, [&](double, double, double d0, double d1, int cell) {
        if (cell < 0 || broken[cell] || -std::min(d0, d1) <= strength) return;
        broken[cell] = 1;
        ++count;
    });
    return count;
}

}  // namespace talus
