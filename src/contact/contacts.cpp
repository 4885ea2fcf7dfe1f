#include "contact/contacts.hpp"

#include "contact/distance_potential.hpp"
#include "contact/face_path.hpp"
#include "contact/law.hpp"
#include "contact/separation.hpp"
#include "model/supports.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace talus {
namespace {

constexpr int chunk = 256;  // blocks per task; fixed, so that sums do not depend on the number of threads
// Depth, as a share of memory_reach, up to which parts only touch: 1e-12 of a block. The corners of cut rock overlap by
// their rounding; the force of such a corner (kn depth^2, 1e-14 N) is nothing, but half of all pairs would go through the
// general law.
constexpr double touch_share = 1e-10;
constexpr double smooth_cos = 0.985;  // edges that meet at less than 10 degrees may not use the face path: which of them is
                                      // in contact would depend on history

bool key_less(const Contact& c, const Pair& p) { return c.part_a < p.a || (c.part_a == p.a && c.part_b < p.b); }

// Pairs that cannot move against each other are not looked at: parts of one block, two held blocks, removed ones.
class Movable {
public:
    Movable(const Model& model, const State& state) : model_(model), removed_(state.removed), fixed_(immovable(model)) {}
    bool operator()(PartId part_a, PartId part_b) const {
        const BlockId a = model_.parts.block[part_a], b = model_.parts.block[part_b];
        return a != b && !removed_[a] && !removed_[b] && !(fixed_[a] && fixed_[b]);
    }

private:
    const Model& model_;
    const std::vector<std::uint8_t>& removed_;
    const std::vector<std::uint8_t> fixed_;
};

struct Work {  // of one chunk of blocks, J
    double friction = 0.0, damping = 0.0, released = 0.0;
};

struct Normal {  // outcome of the geometry of one contact
    Patch patch;
    double kn_force = 0.0;            // m2, signed: > 0 pressed
    double nx = 0.0, ny = 0.0;        // unit, from a to b
    double rotation_stiffness = 0.0;  // m3
};

class Evaluator {
public:
    Evaluator(const Model& model, const Placed& placed, double dt, State& state)
        : model_(model), placed_(placed), dt_(dt), state_(state) {}

    void operator()(int i, Work& work) {
        Contact& c = state_.contacts.list[i];
        const PlacedPart a(model_, placed_, c.part_a), b(model_, placed_, c.part_b);
        const BlockId block_a = model_.parts.block[c.part_a], block_b = model_.parts.block[c.part_b];
        const Vec2& pa = state_.motion.position[block_a];
        const Vec2& pb = state_.motion.position[block_b];
        const double dx = pb.x() - pa.x(), dy = pb.y() - pa.y();

        // A place without memory whose old separating edge still separates: the usual answer for pairs that meet at a
        // corner.
        if (!c.alive && c.edge_a >= 0) {
            const bool of_a = c.edge_a >= a.first && c.edge_a < a.first + a.n;
            const double distance = of_a ? separation_by_edge(a, c.edge_a - a.first, b, dx, dy)
                                         : separation_by_edge(b, c.edge_a - b.first, a, -dx, -dy);
            if (distance >= -touch_depth(c)) return;
        }
        Normal normal;
        if (find_normal(c, a, b, dx, dy, normal))
            load(i, c, block_a, block_b, dx, dy, normal, work);
        else
            unload(i, c, a, b, dx, dy, work);
    }

private:
    double touch_depth(const Contact& c) const { return touch_share * memory_reach(model_, c.part_a, c.part_b); }

    // True if the pair carries a normal force (or an intact bond); sets the edges of the contact.
    bool find_normal(Contact& c, const PlacedPart& a, const PlacedPart& b, double dx, double dy, Normal& out) {
        if (c.dilation == 0.0) return find_overlap(c, a, b, dx, dy, out);
        // Slip has thickened the joint: the same as moving b against a. The force acts at the true place, so that torques
        // still balance.
        const double sx = c.dilation * c.normal.x(), sy = c.dilation * c.normal.y();
        if (!find_overlap(c, a, b, dx - sx, dy - sy, out)) return false;
        out.patch.torque_b -= sx * out.patch.fy - sy * out.patch.fx;
        return true;
    }

    bool find_overlap(Contact& c, const PlacedPart& a, const PlacedPart& b, double dx, double dy, Normal& out) {
        const int old_a = c.alive ? c.edge_a : -1, old_b = c.alive ? c.edge_b : -1;
        if (c.face >= 0 || (model_.face_path && old_a >= 0 && old_b >= 0)) {
            switch (try_face(c, a, b, dx, dy, old_a - a.first, old_b - b.first, out)) {
                case FaceState::loaded:
                    return true;
                case FaceState::open:
                    return false;
                case FaceState::invalid:
                    end_face(c);
            }
        }
        const Separation apart = separation(a, b, dx, dy);
        c.edge_a = -1;
        c.edge_b = -1;
        if (apart.distance >= -touch_depth(c)) {
            c.edge_a = apart.edge + (apart.of_a ? a.first : b.first);
            return false;
        }
        if (model_.face_path) {
            const Vec2& n = apart.of_a ? a.normal[apart.edge] : b.normal[apart.edge];
            const int other = facing_edge(apart.of_a ? b : a, n.x(), n.y());
            const int ea = apart.of_a ? apart.edge : other, eb = apart.of_a ? other : apart.edge;
            if (distinct(a, ea) && distinct(b, eb) && !a.internal[ea] && !b.internal[eb] &&
                try_face(c, a, b, dx, dy, ea, eb, out) == FaceState::loaded) {
                c.edge_a = a.first + ea;
                c.edge_b = b.first + eb;
                return true;
            }
        }
        out.patch = distance_potential(a, b, dx, dy);
        if (!out.patch.loaded) return false;
        out.kn_force = std::sqrt(out.patch.fx * out.patch.fx + out.patch.fy * out.patch.fy);
        if (out.kn_force == 0.0) return false;
        out.nx = out.patch.fx / out.kn_force;
        out.ny = out.patch.fy / out.kn_force;
        return true;
    }

    static bool distinct(const PlacedPart& s, int k) {
        const Vec2 &n = s.normal[k], &p = s.normal[s.previous(k)], &q = s.normal[s.next(k)];
        return n.x() * p.x() + n.y() * p.y() < smooth_cos && n.x() * q.x() + n.y() * q.y() < smooth_cos;
    }

    FaceState try_face(Contact& c, const PlacedPart& a, const PlacedPart& b, double dx, double dy, int ea, int eb,
                       Normal& out) {
        FaceMemory memory;
        const bool remembers = c.face >= 0;
        if (remembers) {
            const JointFace& face = model_.faces[c.face];
            const Joint& joint = model_.joints[c.joint];
            ea = face.edge_a - a.first;
            eb = face.edge_b - b.first;
            std::uint8_t* broken = face.bonded ? &state_.contacts.broken[face.first_cell] : nullptr;
            memory = {face.s0, face.s1, face.sigma0 / joint.kn, face.sigma1 / joint.kn, broken, joint.cells};
            FacePatch patch = face_contact(a, b, dx, dy, ea, eb, &memory);
            if (patch.largest_pull * joint.kn > joint.tension &&
                break_cells(a, b, dx, dy, ea, eb, memory, joint.tension / joint.kn, broken) > 0) {
                patch = face_contact(a, b, dx, dy, ea, eb, &memory);
                if (patch.bonded_length == 0.0) c.slipped = 1;  // all of it has broken: residual strength
            }
            return accept(patch, out);
        }
        return accept(face_contact(a, b, dx, dy, ea, eb, nullptr), out);
    }

    static FaceState accept(const FacePatch& patch, Normal& out) {
        if (patch.state != FaceState::loaded) return patch.state;
        out.patch = patch;
        const double along = patch.fx * patch.nx + patch.fy * patch.ny;
        const double size = std::sqrt(patch.fx * patch.fx + patch.fy * patch.fy);
        // The normal is that of the force; without one (a bond pressed here and pulled there) that of the faces.
        if (std::abs(along) > 0.9 * size && size > 0.0) {
            out.kn_force = along > 0.0 ? size : -size;
            out.nx = patch.fx / out.kn_force;
            out.ny = patch.fy / out.kn_force;
        } else {
            out.kn_force = along;
            out.nx = patch.nx;
            out.ny = patch.ny;
        }
        out.rotation_stiffness = patch.rotation_stiffness;
        return FaceState::loaded;
    }

    // The faces have turned away or slid off: bonds and initial stress are over, for good.
    void end_face(Contact& c) {
        if (c.face < 0) return;
        const JointFace& face = model_.faces[c.face];
        if (face.bonded)
            for (int i = 0; i < model_.joints[c.joint].cells; ++i)
                if (!state_.contacts.broken[face.first_cell + i]) state_.contacts.broken[face.first_cell + i] = 2;
        c.face = -1;
    }

    void load(int i, Contact& c, BlockId block_a, BlockId block_b, double dx, double dy, const Normal& normal, Work& work) {
        const Joint& joint = model_.joints[c.joint];
        const Motion& motion = state_.motion;
        const Patch& p = normal.patch;
        const double nx = normal.nx, ny = normal.ny, tx = -ny, ty = nx;
        const double rax = p.x, ray = p.y, rbx = p.x - dx, rby = p.y - dy;
        const double turning = motion.spin[block_b] - motion.spin[block_a];
        const Vec2 v = relative_velocity(block_a, block_b, {rax, ray}, {rbx, rby});
        const double vn = v.x() * nx + v.y() * ny, vt = v.x() * tx + v.y() * ty;

        // A contact that has moved to other edges keeps the part of its shear force that lies in the new plane.
        if (c.touching && c.shear_force != 0.0) {
            const double turned = c.normal.x() * nx + c.normal.y() * ny;
            if (turned < 0.9999) {
                const double share = std::max(turned, 0.0);
                work.released += c.shear_energy * (1.0 - share * share);
                c.shear_force *= share;
                c.shear_energy *= share * share;
            }
        }

        const double dashpot = dt_ > 0.0 ? model_.contact_damping : 0.0;
        double normal_dashpot = -dashpot * joint.kn * p.length * vn;
        double elastic = joint.kn * normal.kn_force;
        if (p.bonded_length == 0.0) normal_dashpot = std::max(normal_dashpot, -elastic);  // a plain contact cannot pull
        const double moment_dashpot = -dashpot * joint.kn * normal.rotation_stiffness * turning;

        const double face_length = c.face >= 0 ? model_.faces[c.face].s1 - model_.faces[c.face].s0 : 0.0;
        const ShearStep step{elastic + normal_dashpot,           p.length, p.bonded_length, face_length, vt * dt_,
                             -dashpot * joint.ks * p.length * vt};
        const ShearResult shear = MohrCoulomb{}(joint, step, c);
        if (shear.bonds_fail) break_bonds(c);

        c.touching = 1;
        c.alive = 1;
        c.overlap = p.overlap - c.dilation;
        c.normal_force = elastic + normal_dashpot;
        c.normal = {nx, ny};
        c.point = state_.motion.position[block_a] + Vec2(p.x, p.y);

        const double t = c.shear_force + shear.dashpot;
        const double fx = joint.kn * p.fx + normal_dashpot * nx + t * tx;
        const double fy = joint.kn * p.fy + normal_dashpot * ny + t * ty;
        const double other_x = normal_dashpot * nx + t * tx, other_y = normal_dashpot * ny + t * ty;
        Force& on_a = state_.contacts.on_a[i];
        Force& on_b = state_.contacts.on_b[i];
        on_b.force = {fx, fy};
        on_a.force = {-fx, -fy};
        on_b.torque = joint.kn * p.torque_b + (rbx * other_y - rby * other_x) + moment_dashpot;
        on_a.torque = -(joint.kn * p.torque_a + (rax * other_y - ray * other_x) + moment_dashpot);

        work.friction += shear.friction;
        work.released += shear.released;
        work.damping -= (normal_dashpot * vn + shear.dashpot * vt + moment_dashpot * turning) * dt_;
    }

    void unload(int i, Contact& c, const PlacedPart& a, const PlacedPart& b, double dx, double dy, Work& work) {
        if (!c.alive) return;
        if (c.shear_force != 0.0) {
            const BlockId block_a = model_.parts.block[c.part_a], block_b = model_.parts.block[c.part_b];
            const Vec2 v = relative_velocity(block_a, block_b, c.point - state_.motion.position[block_a],
                                             c.point - state_.motion.position[block_b]);
            work.released += c.shear_energy;
            work.friction -= 0.5 * c.shear_force * v.dot(perp(c.normal)) * dt_;
        }
        c.touching = 0;
        c.sliding = 0;
        c.length = c.normal_force = c.shear_force = c.shear_energy = c.strength = 0.0;
        state_.contacts.on_a[i] = Force{};
        state_.contacts.on_b[i] = Force{};
        const Separation apart = separation(a, b, dx, dy);
        c.overlap = -apart.distance;
        if ((c.face < 0 && c.slip == 0.0) || apart.distance > memory_reach(model_, c.part_a, c.part_b)) {
            end_face(c);
            const PartId part_a = c.part_a, part_b = c.part_b;
            c = Contact{part_a, part_b, model_.joint_between(part_a, part_b)};
            c.edge_a = apart.distance >= -touch_depth(c) ? apart.edge + (apart.of_a ? a.first : b.first) : -1;
        }
    }

    // Of b against a, over the step that has just ended, m/s; arms from the centroids. The last terms take the arms back to
    // the middle of the step, or two blocks that turn together would seem to slip (by spin^2 dt/2 x distance).
    Vec2 relative_velocity(BlockId a, BlockId b, const Vec2& arm_a, const Vec2& arm_b) const {
        const Motion& m = state_.motion;
        const double wa = m.spin[a], wb = m.spin[b];
        return m.velocity[b] + wb * perp(arm_b) + (0.5 * dt_ * wb * wb) * arm_b -
               (m.velocity[a] + wa * perp(arm_a) + (0.5 * dt_ * wa * wa) * arm_a);
    }

    void break_bonds(const Contact& c) {
        const JointFace& face = model_.faces[c.face];
        for (int i = 0; i < model_.joints[c.joint].cells; ++i)
            if (!state_.contacts.broken[face.first_cell + i]) state_.contacts.broken[face.first_cell + i] = 2;
    }

    const Model& model_;
    const Placed& placed_;
    double dt_;
    State& state_;
};

void make_incidence(const Model& model, const Contacts& contacts, Incidence& incidence) {
    const int nb = model.blocks.size(), n = static_cast<int>(contacts.list.size());
    incidence.first_of_a.assign(nb + 1, 0);
    incidence.first.assign(nb + 1, 0);
    incidence.entry.resize(2 * static_cast<std::size_t>(n));
    for (const Contact& c : contacts.list) {
        ++incidence.first_of_a[model.parts.block[c.part_a] + 1];
        ++incidence.first[model.parts.block[c.part_a] + 1];
        ++incidence.first[model.parts.block[c.part_b] + 1];
    }
    for (int b = 0; b < nb; ++b) {
        incidence.first_of_a[b + 1] += incidence.first_of_a[b];
        incidence.first[b + 1] += incidence.first[b];
    }
    std::vector<int> place(incidence.first.begin(), incidence.first.end() - 1);
    for (int i = 0; i < n; ++i) {
        incidence.entry[place[model.parts.block[contacts.list[i].part_a]]++] = 2 * i;
        incidence.entry[place[model.parts.block[contacts.list[i].part_b]]++] = 2 * i + 1;
    }
}

}  // namespace

double memory_reach(const Model& model, PartId a, PartId b) {
    return 0.01 * std::min(model.parts.thickness[a], model.parts.thickness[b]);
}

void refresh_contacts(const Model& model, std::span<const Pair> pairs, State& state, Incidence& incidence) {
    const Contacts& old = state.contacts;
    const Movable movable(model, state);
    std::vector<Contact> list;
    std::vector<Force> on_a, on_b;
    const std::size_t room = std::max(pairs.size(), old.list.size());
    list.reserve(room);
    on_a.reserve(room);
    on_b.reserve(room);
    std::size_t i = 0;
    const auto keep = [&](std::size_t k) {
        const Contact& c = old.list[k];
        if (!c.alive || !movable(c.part_a, c.part_b)) return;
        list.push_back(c);
        on_a.push_back(old.on_a[k]);
        on_b.push_back(old.on_b[k]);
    };
    for (const Pair& pair : pairs) {
        if (!movable(pair.a, pair.b)) continue;
        while (i < old.list.size() && key_less(old.list[i], pair)) keep(i++);
        if (i < old.list.size() && old.list[i].part_a == pair.a && old.list[i].part_b == pair.b) {
            list.push_back(old.list[i]);
            on_a.push_back(old.on_a[i]);
            on_b.push_back(old.on_b[i]);
            ++i;
        } else {
            list.push_back(Contact{pair.a, pair.b, model.joint_between(pair.a, pair.b)});
            on_a.emplace_back();
            on_b.emplace_back();
        }
    }
    while (i < old.list.size()) keep(i++);
    state.contacts.list = std::move(list);
    state.contacts.on_a = std::move(on_a);
    state.contacts.on_b = std::move(on_b);
    make_incidence(model, state.contacts, incidence);
}

void update_contacts(const Model& model, const Placed& placed, double dt, State& state, const Incidence& incidence) {
    const int nb = model.blocks.size(), chunks = (nb + chunk - 1) / chunk;
    std::vector<Work> work(chunks);
#pragma omp parallel
    {
        Evaluator evaluate(model, placed, dt, state);
#pragma omp for schedule(dynamic)
        for (int k = 0; k < chunks; ++k) {
            const int end = incidence.first_of_a[std::min((k + 1) * chunk, nb)];
            for (int i = incidence.first_of_a[k * chunk]; i < end; ++i) evaluate(i, work[k]);
        }
    }
    for (const Work& w : work) {
        state.ledger.friction += w.friction;
        state.ledger.contact_damping += w.damping;
        state.ledger.released += w.released;
    }
}

void sum_contacts(const Model& model, const Contacts& contacts, const Incidence& incidence, std::span<Force> load) {
    const int nb = model.blocks.size();
#pragma omp parallel for schedule(static)
    for (int b = 0; b < nb; ++b) {
        double fx = 0.0, fy = 0.0, torque = 0.0;
        for (int e = incidence.first[b]; e < incidence.first[b + 1]; ++e) {
            const int i = incidence.entry[e] >> 1;
            const Force& f = incidence.entry[e] & 1 ? contacts.on_b[i] : contacts.on_a[i];
            fx += f.force.x();
            fy += f.force.y();
            torque += f.torque;
        }
        load[b].force += Vec2(fx, fy);
        load[b].torque += torque;
    }
}

StrainEnergy strain_energy(const Model& model, const Placed& placed, const State& state) {
    StrainEnergy energy;
    for (const Contact& c : state.contacts.list) {
        if (!c.touching) continue;
        const Joint& joint = model.joints[c.joint];
        energy.shear += c.shear_energy;
        const PlacedPart a(model, placed, c.part_a), b(model, placed, c.part_b);
        Vec2 d = state.motion.position[model.parts.block[c.part_b]] - state.motion.position[model.parts.block[c.part_a]];
        d -= c.dilation * c.normal;
        if (c.edge_a < 0 || c.edge_b < 0) {
            energy.normal += joint.kn * distance_potential_energy(a, b, d.x(), d.y());
        } else if (c.face < 0) {
            energy.normal += joint.kn * face_energy(a, b, d.x(), d.y(), c.edge_a - a.first, c.edge_b - b.first, nullptr);
        } else {
            const JointFace& face = model.faces[c.face];
            const FaceMemory memory{face.s0,
                                    face.s1,
                                    face.sigma0 / joint.kn,
                                    face.sigma1 / joint.kn,
                                    face.bonded ? &state.contacts.broken[face.first_cell] : nullptr,
                                    joint.cells};
            energy.normal +=
                joint.kn * face_energy(a, b, d.x(), d.y(), face.edge_a - a.first, face.edge_b - b.first, &memory);
        }
    }
    return energy;
}

}  // namespace talus
