// The loop over all contacts of one step: which kind each is, and what becomes of it.
#include "contact/contacts.hpp"
#include "contact/distance_potential.hpp"
#include "contact/face_batch.hpp"
#include "contact/idle.hpp"
#include "contact/joint_memory.hpp"
#include "contact/response.hpp"
#include "contact/separation.hpp"

#include <algorithm>
#include <utility>

namespace talus {
namespace {

// Edges that meet at less than 10 degrees may not use the face path: which of them is in contact would depend on history.
// Nor may those of corners sharper than 30 degrees: near such a tip the edge behind is as close as the face, which the
// closed form does not know. A blade of 10 degrees that bounces in a box for a million steps gained 5 % of its energy by
// that.
constexpr double smooth_cos = 0.985, sharp_cos = -0.866;  // of the angle between the normals

struct Work {  // of one chunk of blocks, J
    double friction = 0.0, damping = 0.0, released = 0.0;
};

class Evaluator {
public:
    Evaluator(const Model& model, const Placed& placed, double dt, State& state, const ContactIndex& index,
              FaceKernel kernel)
        : model_(model),
          placed_(placed),
          dt_(dt),
          damping_(dt > 0.0 ? model.contact_damping : 0.0),
          state_(state),
          contacts_(state.contacts),
          index_(index),
          kernel_(kernel) {
        for (int k = 0; k < FaceBatch::size; ++k) {
            batch_.a_lo[k] = batch_.a_hi[k] = batch_.b_lo[k] = batch_.b_hi[k] = 1.0;
            joint_of_column_[k] = -1;
            set_memory(k, -1);
        }
    }

    void operator()(ContactIndex::Chunk& chunk, Work& work) {
        work_ = &work;
        changed_ = false;
        if (!chunk.sorted) sort(chunk);
        for (Idle& idle : chunk.idle) {
            if (idle.corner >= 0 && still_apart(model_, placed_, idle)) continue;
            if (idle.edge >= 0 && edge_separates(contacts_.list[idle.slot], idle.edge)) continue;
            evaluate(idle.slot);
            if (!contacts_.list[idle.slot].alive) look_for_edge(idle);
        }
        for (std::size_t j = 0; j < chunk.faces.size(); ++j) {
            if (j + ahead < chunk.faces.size()) fetch(chunk.faces[j + ahead].slot);
            collect(chunk.faces[j]);
        }
        flush();
        for (const int i : chunk.others) evaluate(i);
        chunk.sorted = !changed_;
    }

private:
    struct Couple {  // the two sides of one contact
        PlacedPart a, b;
        BlockId block_a, block_b;
        double dx, dy;  // m, from the centroid of a to that of b
    };

    Couple couple(const Contact& c) const {
        const BlockId a = model_.parts.block[c.part_a], b = model_.parts.block[c.part_b];
        const Vec2 &from = placed_.block[a].position, &to = placed_.block[b].position;
        return {{model_, placed_, c.part_a}, {model_, placed_, c.part_b}, a, b, to.x() - from.x(), to.y() - from.y()};
    }
    // Slip has thickened a joint that dilates: the same as moving b against a.
    static Couple thickened(const Contact& c, Couple s) {
        s.dx -= c.dilation * c.normal.x();
        s.dy -= c.dilation * c.normal.y();
        return s;
    }
    Approach approach(const Couple& s) const {
        const PlacedBlock &a = placed_.block[s.block_a], &b = placed_.block[s.block_b];
        return {a.velocity.x(), a.velocity.y(), a.spin, b.velocity.x(), b.velocity.y(), b.spin, s.dx, s.dy};
    }
    double face_length(const Contact& c) const {
        return c.face >= 0 ? model_.faces[c.face].s1 - model_.faces[c.face].s0 : 0.0;
    }

    // The usual answer for pairs that meet at a corner.
    bool edge_separates(const Contact& c, int edge) const {
        const Couple s = couple(c);
        const bool of_a = edge >= s.a.first && edge < s.a.first + s.a.n;
        const double distance = of_a ? separation_by_edge(s.a, edge - s.a.first, s.b, s.dx, s.dy)
                                     : separation_by_edge(s.b, edge - s.b.first, s.a, -s.dx, -s.dy);
        return distance >= -touch_depth(model_, c.part_a, c.part_b);
    }
    // Contacts lie further apart than the processor looks ahead on its own.
    static constexpr std::size_t ahead = 8;
    void fetch(int i) const {
        const char* contact = reinterpret_cast<const char*>(&contacts_.list[i]);
        for (std::size_t line = 0; line < sizeof(Contact); line += 64) __builtin_prefetch(contact + line, 1);
        __builtin_prefetch(&contacts_.reaction[i], 1);
    }

    void look_for_edge(Idle& idle) const {
        const Contact& c = contacts_.list[idle.slot];
        const Couple s = couple(c);
        const Separation apart = separation(s.a, s.b, s.dx, s.dy);
        // Since the refresh both blocks may have moved by the skin, and may move back as far on the other side.
        const int slot = idle.slot;
        if (apart.edge < 0) return;  // no finite place: the step ends with a report
        idle = keep_apart(model_, placed_, c.part_a, c.part_b, apart, 2.0 * index_.skin).idle;
        idle.slot = slot;
    }
    // Which contact is of which kind: after a refresh, and after contacts have begun, ended or changed their edges.
    void sort(ContactIndex::Chunk& chunk) const {
        const std::vector<Idle> known = std::exchange(chunk.idle, {});
        auto next = known.begin();
        chunk.faces.clear();
        chunk.others.clear();
        for (int i = chunk.begin; i < chunk.end; ++i) {
            const Contact& c = contacts_.list[i];
            if (both_frozen(c)) continue;
            while (next != known.end() && next->slot < i) ++next;
            if (!c.alive)
                chunk.idle.push_back(next != known.end() && next->slot == i ? *next : Idle{.slot = i});
            else if (plain_face(c))
                chunk.faces.push_back(face_slot(i));
            else
                chunk.others.push_back(i);
        }
        chunk.sorted = true;
    }

    bool both_frozen(const Contact& c) const {
        return state_.frozen(model_.parts.block[c.part_a]) && state_.frozen(model_.parts.block[c.part_b]);
    }

    // ---- faces without intact bonds: many at a time

    bool plain_face(const Contact& c) const {
        if (c.edge_a < 0 || c.edge_b < 0) return false;
        return c.face >= 0 ? !bonded(model_.faces[c.face]) : model_.face_path;
    }
    bool bonded(const JointFace& face) const {  // still
        if (!face.bonded) return false;
        const auto first = contacts_.broken.begin() + face.first_cell;
        return std::find(first, first + model_.joints[face.joint].cells, 0) != first + model_.joints[face.joint].cells;
    }
    FaceSlot face_slot(int i) const {
        const Contact& c = contacts_.list[i];
        const Parts& parts = model_.parts;
        const auto next = [&](PartId p, int k) {
            return k + 1 == parts.first_corner[p + 1] ? parts.first_corner[p] : k + 1;
        };
        return {i,        parts.block[c.part_a],    parts.block[c.part_b],
                c.edge_a, next(c.part_a, c.edge_a), next(c.part_b, c.edge_b),
                c.edge_b};
    }

    void collect(const FaceSlot& f) {
        const Contact& c = contacts_.list[f.slot];
        const PlacedBlock &a = placed_.block[f.block_a], &b = placed_.block[f.block_b];
        const PlacedCorner &a0 = placed_.corner[f.a0], &b1 = placed_.corner[f.b1];
        const Vec2 &a1 = placed_.corner[f.a1].arm, &b0 = placed_.corner[f.b0].arm;
        FaceBatch& q = batch_;
        const int k = q.count++;
        q.slot[k] = f.slot;
        q.a0x[k] = a0.arm.x(), q.a0y[k] = a0.arm.y(), q.a1x[k] = a1.x(), q.a1y[k] = a1.y();
        q.nax[k] = a0.normal.x(), q.nay[k] = a0.normal.y();
        q.b0x[k] = b0.x(), q.b0y[k] = b0.y(), q.b1x[k] = b1.arm.x(), q.b1y[k] = b1.arm.y();
        q.nbx[k] = b1.normal.x(), q.nby[k] = b1.normal.y();
        q.dx[k] = b.position.x() - a.position.x(), q.dy[k] = b.position.y() - a.position.y();
        if (!convex_) set_ends(k, couple(c), c.edge_a, c.edge_b);
        q.vax[k] = a.velocity.x(), q.vay[k] = a.velocity.y(), q.spin_a[k] = a.spin;
        q.vbx[k] = b.velocity.x(), q.vby[k] = b.velocity.y(), q.spin_b[k] = b.spin;
        if (c.joint != joint_of_column_[k]) set_joint(k, c.joint);
        q.force[k] = c.shear_force, q.energy[k] = c.shear_energy, q.slip[k] = c.slip, q.slip_sum[k] = c.slip_sum;
        q.dilation[k] = c.dilation, q.slipped[k] = c.slipped, q.nx[k] = c.normal.x(), q.ny[k] = c.normal.y();
        if (c.face >= 0 || q.remembers[k] != 0.0) set_memory(k, c.face);
        if (q.count == FaceBatch::size) flush();
    }

    void set_ends(int k, const Couple& s, int edge_a, int edge_b) {
        const FaceLines f = face_lines(s.a, s.b, s.dx, s.dy, edge_a - s.a.first, edge_b - s.b.first);
        batch_.a_lo[k] = f.a_lo, batch_.a_hi[k] = f.a_hi, batch_.b_lo[k] = f.b_lo, batch_.b_hi[k] = f.b_hi;
    }

    void set_joint(int k, int j) {
        const Joint& joint = model_.joints[j];
        FaceBatch& q = batch_;
        q.kn[k] = joint.kn, q.ks[k] = joint.ks, q.tan_friction[k] = joint.tan_friction;
        q.tan_friction_residual[k] = joint.tan_friction_residual, q.cohesion_residual[k] = joint.cohesion_residual;
        q.weakens[k] = joint.weakens, q.tan_dilation[k] = joint.tan_dilation;
        q.dilation_cutoff_slip[k] = joint.dilation_cutoff_slip;
        joint_of_column_[k] = j;
    }

    void set_memory(int k, int f) {
        FaceBatch& q = batch_;
        q.remembers[k] = f >= 0, q.s0[k] = 0.0, q.s1[k] = 1.0, q.sigma0[k] = q.sigma1[k] = q.face_length[k] = 0.0;
        if (f < 0) return;
        const JointFace& face = model_.faces[f];
        q.s0[k] = face.s0, q.s1[k] = face.s1, q.sigma0[k] = face.sigma0, q.sigma1[k] = face.sigma1;
        q.face_length[k] = face.s1 - face.s0;
    }

    void flush() {
        if (batch_.count == 0) return;
        kernel_(batch_, dt_, damping_);
        const int count = std::exchange(batch_.count, 0);
        for (int k = 0; k < count; ++k) {
            const int i = batch_.slot[k];
            Contact& c = contacts_.list[i];
            const bool valid = batch_.valid[k] != 0.0, loaded = batch_.loaded[k] != 0.0;
            if (valid && loaded) {
                take(k, i);
            } else if (valid && c.face >= 0) {
                unload(i, couple(c));
            } else {  // turned away, or open here: other edges may touch
                if (c.face >= 0) end_face(c, couple(c));
                c.edge_a = c.edge_b = -1;
                changed_ = true;
                evaluate(i);
            }
        }
    }

    void take(int k, int i) {
        const FaceBatch& q = batch_;
        Contact& c = contacts_.list[i];
        c.touching = 1;
        c.sliding = q.sliding[k] != 0.0, c.slipped = q.slipped[k] != 0.0;
        c.length = q.length[k], c.overlap = q.overlap[k] - q.dilation[k];
        c.normal_force = q.normal_force[k], c.shear_force = q.force[k], c.shear_energy = q.energy[k];
        c.strength = q.strength[k], c.slip = q.slip[k], c.slip_sum = q.slip_sum[k], c.dilation = q.dilation[k];
        c.point = placed_.block[model_.parts.block[c.part_a]].position + Vec2(q.x[k], q.y[k]);
        c.normal = {q.nx[k], q.ny[k]};
        contacts_.reaction[i] = {{q.fx[k], q.fy[k]}, q.torque_a[k], q.torque_b[k]};
        work_->friction += q.friction[k];
        work_->damping += q.damping[k];
        work_->released += q.released[k];
    }

    // ---- corners, bonds, and what changes its kind: one at a time

    void evaluate(int i) {
        Contact& c = contacts_.list[i];
        const Couple s = couple(c);
        const Couple shifted = thickened(c, s);
        const int edge_a = c.edge_a, edge_b = c.edge_b;
        Pressed pressed = press(c, shifted);
        changed_ |= c.edge_a != edge_a || c.edge_b != edge_b;
        if (!pressed.loaded()) return unload(i, s);
        // The force acts at the true place.
        pressed.torque_b -= (s.dx - shifted.dx) * pressed.fy - (s.dy - shifted.dy) * pressed.fx;
        load(i, s, pressed);
    }

    // The normal part; not loaded if the pair carries nothing. Sets the edges of the contact.
    Pressed press(Contact& c, const Couple& s) {
        if (c.face >= 0) {
            const FaceContact face = remembered_face(c, s);
            if (face.state != FaceState::invalid) return face.pressed;
            end_face(c, s);
        }
        c.edge_a = c.edge_b = -1;
        const Separation apart = separation(s.a, s.b, s.dx, s.dy);
        if (apart.distance >= -touch_depth(model_, c.part_a, c.part_b)) return {};
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

    // Whether edge k may use the face path.
    static bool distinct(const PlacedPart& s, int k) {
        const Vec2 &n = s.normal(k), &p = s.normal(s.previous(k)), &q = s.normal(s.next(k));
        const double before = n.x() * p.x() + n.y() * p.y(), after = n.x() * q.x() + n.y() * q.y();
        return std::max(before, after) < smooth_cos && std::min(before, after) > sharp_cos;
    }

    FaceContact remembered_face(Contact& c, const Couple& s) {
        const JointFace& face = model_.faces[c.face];
        const Joint& joint = model_.joints[c.joint];
        const int ea = face.edge_a - s.a.first, eb = face.edge_b - s.b.first;
        const FaceMemory memory = joint_memory(face, joint, contacts_.broken);
        FaceContact contact = face_contact(s.a, s.b, s.dx, s.dy, ea, eb, &memory);
        if (contact.largest_pull * joint.kn > joint.tension) {
            const double before = bond_energy(c, s);
            if (break_cells(s.a, s.b, s.dx, s.dy, ea, eb, memory, joint.tension / joint.kn,
                            &contacts_.broken[face.first_cell]) > 0) {
                work_->released += before - bond_energy(c, s);
                changed_ = true;
                contact = face_contact(s.a, s.b, s.dx, s.dy, ea, eb, &memory);
                if (contact.pressed.bonded_length == 0.0) c.slipped = 1;  // all of it has broken: residual strength
            }
        }
        return contact;
    }

    void load(int i, const Couple& s, const Pressed& p) {
        Contact& c = contacts_.list[i];
        ShearMemory shear{c.shear_force, c.shear_energy, c.slip, c.slip_sum, c.dilation, c.slipped ? 1.0 : 0.0};
        const Response r = respond(model_.joints[c.joint], p, approach(s), dt_, damping_, face_length(c),
                                   {c.normal.x(), c.normal.y()}, shear);
        if (r.bonds_fail) break_bonds(c, thickened(c, s));
        changed_ |= !c.alive;
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
        work_->friction += r.friction;
        work_->damping += r.damping;
        work_->released += r.released;
    }

    void unload(int i, const Couple& s) {
        Contact& c = contacts_.list[i];
        if (!c.alive) return;
        if (c.shear_force != 0.0) {
            const Vec2 arm = c.point - placed_.block[s.block_a].position;
            const Vector v = relative_velocity(approach(s), arm.x(), arm.y(), dt_);
            work_->released += c.shear_energy;
            work_->friction -= 0.5 * c.shear_force * (v.y * c.normal.x() - v.x * c.normal.y()) * dt_;
        }
        c.touching = 0;
        c.sliding = 0;
        c.length = c.normal_force = c.shear_force = c.shear_energy = c.strength = 0.0;
        contacts_.reaction[i] = {};
        const Separation apart = separation(s.a, s.b, s.dx, s.dy);
        c.overlap = -apart.distance;
        if ((c.face < 0 && !c.slipped) || apart.distance - c.dilation > memory_reach(model_, c.part_a, c.part_b)) {
            if (c.face >= 0) end_face(c, s);
            const PartId part_a = c.part_a, part_b = c.part_b;
            c = Contact{part_a, part_b, model_.joint_between(part_a, part_b)};
            changed_ = true;
        }
    }

    // The faces have turned away or slid off: bonds and initial stress are over, for good.
    void end_face(Contact& c, const Couple& s) {
        break_bonds(c, s);
        c.face = -1;
    }

    void break_bonds(const Contact& c, const Couple& s) {
        const JointFace& face = model_.faces[c.face];
        if (!face.bonded) return;
        changed_ = true;
        const double before = bond_energy(c, s);
        for (int i = 0; i < model_.joints[face.joint].cells; ++i)
            if (!contacts_.broken[face.first_cell + i]) contacts_.broken[face.first_cell + i] = 2;
        work_->released += before - bond_energy(c, s);
    }

    double bond_energy(const Contact& c, const Couple& s) const {  // J, normal part
        const JointFace& face = model_.faces[c.face];
        const Joint& joint = model_.joints[c.joint];
        const FaceMemory memory = joint_memory(face, joint, contacts_.broken);
        return joint.kn * face_energy(s.a, s.b, s.dx, s.dy, face.edge_a - s.a.first, face.edge_b - s.b.first, &memory);
    }

    const Model& model_;
    const Placed& placed_;
    double dt_, damping_;
    const State& state_;
    Contacts& contacts_;
    const ContactIndex& index_;
    FaceKernel kernel_;
    const bool convex_ = model_.parts.size() == model_.blocks.size();  // no block has an edge inside it
    FaceBatch batch_{};
    int joint_of_column_[FaceBatch::size];
    Work* work_ = nullptr;
    bool changed_ = false;  // a contact of this chunk has begun or ended, or is of another kind now
};

}  // namespace

void update_contacts(const Model& model, const Placed& placed, double dt, State& state, ContactIndex& index) {
    static const FaceKernel kernel = face_kernel(best_vector_unit());
    const int chunks = static_cast<int>(index.chunks.size());
    std::vector<Work> work(chunks);
#pragma omp parallel
    {
        Evaluator evaluate(model, placed, dt, state, index, kernel);
#pragma omp for schedule(dynamic)
        for (int k = 0; k < chunks; ++k) evaluate(index.chunks[k], work[k]);
    }
    for (const Work& w : work) {
        state.ledger.friction += w.friction;
        state.ledger.contact_damping += w.damping;
        state.ledger.released += w.released;
    }
}

}  // namespace talus
