#include "contact/single_contacts.hpp"

#include "contact/distance_potential.hpp"
#include "contact/joint_memory.hpp"
#include "contact/rounded_corners.hpp"

#include <algorithm>

namespace talus {
namespace {

// Edges that meet at less than 10 degrees may not use the face path: which of them is in contact would depend on history.
// Nor may those of corners sharper than 30 degrees: near such a tip the edge behind is as close as the face, which the
// closed form does not know. A blade of 10 degrees that bounces in a box for a million steps gained 5 % of its energy by
// that.
constexpr double smooth_cos = 0.985, sharp_cos = -0.866;  // of the angle between the normals

// Whether edge k may use the face path.
bool distinct(const PlacedPart& s, int k) {
    const Vec2 &n = s.normal(k), &p = s.normal(s.previous(k)), &q = s.normal(s.next(k));
    const double before = n.x() * p.x() + n.y() * p.y(), after = n.x() * q.x() + n.y() * q.y();
    return std::max(before, after) < smooth_cos && std::min(before, after) > sharp_cos;
}

// Slip has thickened a joint that dilates: the same as moving b against a.
Couple thickened(const Contact& c, Couple s) {
    s.dx -= c.dilation * c.normal.x();
    s.dy -= c.dilation * c.normal.y();
    return s;
}

// The first corner of q inside p, which lies at (dx, dy) from it; -1 if there is none.
int corner_inside(const PlacedPart& q, const PlacedPart& p, double dx, double dy) {
    for (int i = 0; i < q.n; ++i) {
        const double x = q.arm(i).x() - dx, y = q.arm(i).y() - dy;
        int k = 0;
        while (k < p.n && p.normal(k).x() * x + p.normal(k).y() * y < p.offset[k]) ++k;
        if (k == p.n) return i;
    }
    return -1;
}

// m, how near the other edges of a part come to its corner k. From the corners as they were drawn: the same in every step.
double clearance(const Model& model, const PlacedPart& part, int k) {
    double nearest = 1e300;
    const Vec2 corner = model.corners.arm[part.first + k];
    for (int j = 0; j < part.n; ++j)
        if (j != k && j != part.previous(k))
            nearest = std::min(nearest, part.offset[j] - model.corners.normal[part.first + j].dot(corner));
    return nearest;
}

std::optional<CornerSlot> find_corners(const Model& model, const Contact& c, const Couple& s) {
    const int a = corner_inside(s.a, s.b, s.dx, s.dy), b = corner_inside(s.b, s.a, -s.dx, -s.dy);
    if (a < 0 || b < 0) return {};
    const int a_before = s.a.previous(a), b_before = s.b.previous(b);
    if (s.a.internal[a] || s.a.internal[a_before] || s.b.internal[b] || s.b.internal[b_before]) return {};
    const double reach = 0.5 * std::min(clearance(model, s.a, a), clearance(model, s.b, b));
    return CornerSlot{-1,
                      s.block_a,
                      s.block_b,
                      s.a.first + a,
                      s.a.first + a_before,
                      s.b.first + b,
                      s.b.first + b_before,
                      reach,
                      touch_depth(model, c.part_a, c.part_b)};
}

}  // namespace

CornerLines corner_lines(const Placed& placed, const CornerSlot& f, double dx, double dy) {
    const PlacedCorner &a = placed.corner[f.a], &b = placed.corner[f.b];
    const Vec2 &a_before = placed.corner[f.a_before].normal, &b_before = placed.corner[f.b_before].normal;
    return {a.arm.x(),    a.arm.y(),    a_before.x(), a_before.y(), a.normal.x(), a.normal.y(), b.arm.x(), b.arm.y(),
            b_before.x(), b_before.y(), b.normal.x(), b.normal.y(), dx,           dy,           f.reach,   f.touch_depth};
}

Approach SingleContacts::approach(const Couple& s) const {
    const PlacedBlock &a = placed_.block[s.block_a], &b = placed_.block[s.block_b];
    return {a.velocity.x(), a.velocity.y(), a.spin, b.velocity.x(), b.velocity.y(), b.spin, s.dx, s.dy};
}

double SingleContacts::face_length(const Contact& c) const {
    return c.face >= 0 ? model_.faces[c.face].s1 - model_.faces[c.face].s0 : 0.0;
}

std::optional<CornerSlot> SingleContacts::corners(int i) const {
    const Contact& c = list_[i];
    if (c.face >= 0 || c.edge_a >= 0 || !c.touching || model_.rounding_length > 0.0) return {};
    const Couple s = thickened(c, couple(model_, placed_, c));
    std::optional<CornerSlot> found = find_corners(model_, c, s);
    if (!found || !corner_pair(corner_lines(placed_, *found, s.dx, s.dy)).valid) return {};
    found->slot = i;
    return found;
}

void SingleContacts::evaluate(int i) {
    Contact& c = list_[i];
    const Couple s = couple(model_, placed_, c);
    const Couple shifted = thickened(c, s);
    const int edge_a = c.edge_a, edge_b = c.edge_b;
    Separation apart;
    Pressed pressed = press(c, shifted, apart);
    changed |= c.edge_a != edge_a || c.edge_b != edge_b;
    if (!pressed.loaded()) return part(i, s, apart);
    // The force acts at the true place; bit for bit as in batches.
    const Vec2 thicker = c.dilation * c.normal;
    pressed.torque_b -= thicker.x() * pressed.fy - thicker.y() * pressed.fx;
    load(i, s, pressed);
}

// The normal part; not loaded if the pair carries nothing, and `apart` then says how far from doing so, if it was found.
// Sets the edges of the contact.
Pressed SingleContacts::press(Contact& c, const Couple& s, Separation& apart) {
    if (c.face >= 0) {
        const FaceContact face = remembered_face(c, s);
        if (face.state != FaceState::invalid) return face.pressed;
        end_face(c, s);
    }
    c.edge_a = c.edge_b = -1;
    apart = separation(s.a, s.b, s.dx, s.dy);
    if (apart.distance >= -touch_depth(model_, c.part_a, c.part_b)) return {};
    if (model_.rounding_length > 0.0) return rounded_contact(model_, s.a, s.b, s.dx, s.dy);
    if (const auto found = find_corners(model_, c, s)) {
        const CornerPair pair = corner_pair(corner_lines(placed_, *found, s.dx, s.dy));
        changed |= pair.valid;  // from now on one of many
        if (pair.valid) return pair.pressed;
    }
    if (model_.face_path) {
        const Vec2& n = apart.of_a ? s.a.normal(apart.edge) : s.b.normal(apart.edge);
        const int other = facing_edge(apart.of_a ? s.b : s.a, n.x(), n.y());
        const int ea = apart.of_a ? apart.edge : other, eb = apart.of_a ? other : apart.edge;
        if (distinct(s.a, ea) && distinct(s.b, eb) && !s.a.internal[ea] && !s.b.internal[eb]) {
            const FaceContact face = face_contact(s.a, s.b, s.dx, s.dy, ea, eb, nullptr);
            if (face.state == FaceState::loaded) {
                c.edge_a = s.a.first + ea;
                c.edge_b = s.b.first + eb;
                return face.pressed;
            }
        }
    }
    return distance_potential(s.a, s.b, s.dx, s.dy);
}

FaceContact SingleContacts::remembered_face(Contact& c, const Couple& s) {
    const JointFace& face = model_.faces[c.face];
    const Joint& joint = model_.joints[c.joint];
    const int ea = face.edge_a - s.a.first, eb = face.edge_b - s.b.first;
    const FaceMemory memory = joint_memory(face, joint, contacts_.broken);
    FaceContact contact = face_contact(s.a, s.b, s.dx, s.dy, ea, eb, &memory);
    if (contact.largest_pull * joint.kn > joint.tension) {
        const double before = bond_energy(c, s);
        if (break_cells(s.a, s.b, s.dx, s.dy, ea, eb, memory, joint.tension / joint.kn, &contacts_.broken[face.first_cell]) >
            0) {
            work.released += before - bond_energy(c, s);
            changed = true;
            contact = face_contact(s.a, s.b, s.dx, s.dy, ea, eb, &memory);
            if (contact.pressed.bonded_length == 0.0) c.slipped = 1;  // all of it has broken: residual strength
        }
    }
    return contact;
}

void SingleContacts::load(int i, const Couple& s, const Pressed& p) {
    Contact& c = list_[i];
    ShearMemory shear{c.shear_force, c.shear_energy, c.slip, c.slip_sum, c.dilation, c.slipped ? 1.0 : 0.0};
    const Response r =
        respond(model_.joints[c.joint], p, approach(s), dt_, damping_, face_length(c), {c.normal.x(), c.normal.y()}, shear);
    if (r.bonds_fail) break_bonds(c, thickened(c, s));
    changed |= !c.alive;
    c.touching = c.alive = 1;
    c.sliding = r.sliding;
    c.slipped = shear.slipped != 0.0;
    c.length = p.length;
    c.overlap = p.overlap - shear.dilation;
    c.normal_force = r.normal_force;
    c.shear_force = shear.force;
    c.shear_energy = shear.energy;
    c.strength = r.strength;
    c.slip = shear.slip;
    c.slip_sum = shear.slip_sum;
    c.dilation = shear.dilation;
    c.point = placed_.block[s.block_a].position + Vec2(p.x, p.y);
    c.normal = {p.nx, p.ny};
    contacts_.reaction[i] = {{r.fx, r.fy}, r.torque_a, r.torque_b};
    work.friction += r.friction;
    work.damping += r.damping;
    work.released += r.released;
}

void SingleContacts::unload(int i) { part(i, couple(model_, placed_, list_[i]), {}); }

void SingleContacts::part(int i, const Couple& s, const Separation& known) {
    Contact& c = list_[i];
    if (!c.alive) return;
    if (c.shear_force != 0.0) {
        const Vec2 arm = c.point - placed_.block[s.block_a].position;
        const Vector v = relative_velocity(approach(s), arm.x(), arm.y(), dt_);
        work.released += c.shear_energy;
        work.friction -= 0.5 * c.shear_force * (v.y * c.normal.x() - v.x * c.normal.y()) * dt_;
    }
    c.touching = 0;
    c.sliding = 0;
    c.length = c.normal_force = c.shear_force = c.shear_energy = c.strength = 0.0;
    contacts_.reaction[i] = {};
    const Separation apart = known.edge >= 0 && c.dilation == 0.0 ? known : separation(s.a, s.b, s.dx, s.dy);
    c.overlap = -apart.distance;
    if (!remembers(model_, c) || apart.distance - c.dilation > memory_reach(model_, c.part_a, c.part_b)) {
        if (c.face >= 0) end_face(c, s);
        const PartId part_a = c.part_a, part_b = c.part_b;
        c = Contact{part_a, part_b, model_.joint_between(part_a, part_b)};
        changed = true;
    }
}

void SingleContacts::end_face(int i) { end_face(list_[i], couple(model_, placed_, list_[i])); }

void SingleContacts::end_face(Contact& c, const Couple& s) {
    break_bonds(c, s);
    c.face = -1;
}

void SingleContacts::break_bonds(const Contact& c, const Couple& s) {
    const JointFace& face = model_.faces[c.face];
    if (!face.bonded) return;
    changed = true;
    const double before = bond_energy(c, s);
    for (int i = 0; i < model_.joints[face.joint].cells; ++i)
        if (!contacts_.broken[face.first_cell + i]) contacts_.broken[face.first_cell + i] = 2;
    work.released += before - bond_energy(c, s);
}

double SingleContacts::bond_energy(const Contact& c, const Couple& s) const {  // J, normal part
    const JointFace& face = model_.faces[c.face];
    const Joint& joint = model_.joints[c.joint];
    const FaceMemory memory = joint_memory(face, joint, contacts_.broken);
    return joint.kn * face_energy(s.a, s.b, s.dx, s.dy, face.edge_a - s.a.first, face.edge_b - s.b.first, &memory);
}

}  // namespace talus
