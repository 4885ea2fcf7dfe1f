// The loop over all contacts of one step: which kind each is, and what becomes of it.
#include "contact/contacts.hpp"
#include "contact/idle.hpp"
#include "contact/single_contacts.hpp"
#include "contact/threads.hpp"

#include <algorithm>
#include <utility>

namespace talus {
namespace {

struct Kernels {
    FaceKernel faces;
    CornerKernel corners;
};

class Evaluator {
public:
    Evaluator(const Model& model, const Placed& placed, double dt, State& state, const ContactIndex& index, Batches& batches,
              const Kernels& kernels)
        : model_(model),
          placed_(placed),
          dt_(dt),
          damping_(dt > 0.0 ? model.contact_damping : 0.0),
          state_(state),
          contacts_(state.contacts),
          list_(state.contacts.list.behind()),
          index_(index),
          kernels_(kernels),
          faces_(batches.faces),
          corners_(batches.corners),
          single_(model, placed, dt, state.contacts) {
        std::ranges::fill(faces_.joint_of, -1);  // a stage may have changed the joints
        std::ranges::fill(corners_.joint_of, -1);
    }

    void operator()(ContactIndex::Chunk& chunk, FaceTable& table, ContactWork& work) {
        single_.work = {};
        table_ = &table;
        pace_ = chunk.pace;
        // To put one contact into its place takes as long as to look at some eight in their order.
        if (!chunk.sorted || 8 * static_cast<int>(chunk.changed.size()) > chunk.end - chunk.begin)
            sort(chunk);
        else
            sort_changed(chunk);
        changed_ = &chunk.changed;
        for (Idle& idle : chunk.idle) {
            if (not_yet(placed_, idle)) continue;
            if (idle.corner >= 0 && still_apart(model_, placed_, idle)) continue;
            if (idle.edge >= 0 && edge_separates(list_[idle.slot], idle.edge)) continue;
            evaluate_single(idle.slot);
            if (!list_[idle.slot].alive) look_for_edge(idle);
        }
        std::span<const FaceSlot> faces = chunk.faces;
        for (int batch = 0; !faces.empty(); ++batch) {
            const std::size_t count = std::min<std::size_t>(faces.size(), FaceBatch::size);
            const auto next = faces.subspan(count);
            compute_faces(faces.first(count), table.columns(batch), [&] {
                if (next.empty()) return;
                fetch(table.columns(batch + 1));
                for (const FaceSlot& f : next.first(std::min<std::size_t>(next.size(), FaceBatch::size))) fetch(f);
            });
            faces = next;
        }
        for (const CornerSlot& corner : chunk.corners) collect(corner);
        finish_corners();
        for (const int i : chunk.others) evaluate_single(i);
        work = single_.work;
    }

private:
    // The usual answer for pairs that meet at a corner.
    bool edge_separates(const Contact& c, int edge) const {
        const Couple s = couple(model_, placed_, c);
        const bool of_a = edge >= s.a.first && edge < s.a.first + s.a.n;
        const double distance = of_a ? separation_by_edge(s.a, edge - s.a.first, s.b, s.dx, s.dy)
                                     : separation_by_edge(s.b, edge - s.b.first, s.a, -s.dx, -s.dy);
        return distance >= -touch_depth(model_, c.part_a, c.part_b);
    }

    void look_for_edge(Idle& idle) const {
        const Contact& c = list_[idle.slot];
        const Couple s = couple(model_, placed_, c);
        const Separation apart = separation(s.a, s.b, s.dx, s.dy);
        // Since the refresh both blocks may have moved by the skin, and may move back as far on the other side.
        const int slot = idle.slot;
        if (apart.edge < 0) return;  // no finite place: the step ends with a report
        idle = keep_apart(model_, placed_, c.part_a, c.part_b, apart, 2.0 * index_.skin).idle;
        idle.slot = slot;
    }
    void evaluate_single(int i) {
        single_.evaluate(i);
        note(i);
    }
    void note(int i) {
        if (std::exchange(single_.changed, false)) changed_->push_back(i);
    }

    // ---- which contact is of which kind

    void sort(ContactIndex::Chunk& chunk) const {  // after a refresh, and where many blocks froze or woke
        const std::vector<Idle> known = std::exchange(chunk.idle, {});
        auto next = known.begin();
        table_->store(list_);
        table_->clear();
        chunk.faces.clear();
        chunk.corners.clear();
        chunk.others.clear();
        chunk.changed.clear();
        for (int i = chunk.begin; i < chunk.end; ++i) {
            if (left_out(list_[i])) continue;
            while (next != known.end() && next->slot < i) ++next;
            add(i, next != known.end() && next->slot == i ? *next : Idle{.slot = i}, chunk);
        }
        chunk.sorted = true;
    }

    // What has begun or ended in the step before, or changed its edges, and contacts of blocks that froze or woke.
    void sort_changed(ContactIndex::Chunk& chunk) const {
        for (const int i : chunk.changed) {
            remove_face(i, chunk);
            remove(chunk.corners, i);
            remove(chunk.others, i);
            remove(chunk.idle, i);
            if (!left_out(list_[i])) add(i, {.slot = i}, chunk);
        }
        chunk.changed.clear();
    }

    void add(int i, const Idle& idle, ContactIndex::Chunk& chunk) const {
        const Contact& c = list_[i];
        if (!c.alive)
            insert(chunk.idle, idle);
        else if (plain_face(c))
            insert_face(i, chunk);
        else if (const auto corners = single_.corners(i))
            insert(chunk.corners, *corners);
        else
            insert(chunk.others, i);
    }

    static int slot_of(int i) { return i; }
    template <class Kind>
    static int slot_of(const Kind& kind) {
        return kind.slot;
    }
    template <class Kind>
    static auto place_of(std::vector<Kind>& all, int slot) {
        return std::ranges::lower_bound(all, slot, {}, [](const Kind& kind) { return slot_of(kind); });
    }
    template <class Kind>
    static void insert(std::vector<Kind>& all, const Kind& one) {
        all.insert(place_of(all, slot_of(one)), one);
    }
    template <class Kind>
    static void remove(std::vector<Kind>& all, int slot) {
        const auto place = place_of(all, slot);
        if (place != all.end() && slot_of(*place) == slot) all.erase(place);
    }

    void insert_face(int i, ContactIndex::Chunk& chunk) const {
        const auto place = place_of(chunk.faces, i);
        table_->insert(static_cast<int>(place - chunk.faces.begin()), i, list_[i], model_.faces);
        chunk.faces.insert(place, face_slot(i));
    }
    void remove_face(int i, ContactIndex::Chunk& chunk) const {
        const auto place = place_of(chunk.faces, i);
        if (place == chunk.faces.end() || place->slot != i) return;
        const int at = static_cast<int>(place - chunk.faces.begin());
        table_->store(at, list_);
        table_->erase(at);
        chunk.faces.erase(place);
    }

    bool left_out(const Contact& c) const {  // of this chunk
        const BlockId a = model_.parts.block[c.part_a], b = model_.parts.block[c.part_b];
        if (state_.frozen(a) && state_.frozen(b)) return true;
        return pace_ != Pace::all && (pace_ == Pace::fast) != (state_.is_fast(a) || state_.is_fast(b));
    }

    // ---- what all batches have in common

    void collect_common(ContactBatch& q, int k, int i, int joint, BlockId block_a, BlockId block_b) const {
        const PlacedBlock &a = placed_.block[block_a], &b = placed_.block[block_b];
        q.slot[k] = i;
        q.position_x[k] = a.position.x(), q.position_y[k] = a.position.y();
        q.dx[k] = b.position.x() - a.position.x(), q.dy[k] = b.position.y() - a.position.y();
        q.vax[k] = a.velocity.x(), q.vay[k] = a.velocity.y(), q.spin_a[k] = a.spin;
        q.vbx[k] = b.velocity.x(), q.vby[k] = b.velocity.y(), q.spin_b[k] = b.spin;
        if (joint != q.joint_of[k]) set_joint(q, k, joint);
    }

    void set_joint(ContactBatch& q, int k, int j) const {
        const Joint& joint = model_.joints[j];
        q.joint_of[k] = j;
        q.kn[k] = joint.kn, q.ks[k] = joint.ks, q.tan_friction[k] = joint.tan_friction;
        q.tan_friction_residual[k] = joint.tan_friction_residual, q.cohesion_residual[k] = joint.cohesion_residual;
        q.weakens[k] = joint.weakens, q.tan_dilation[k] = joint.tan_dilation;
        q.dilation_cutoff_slip[k] = joint.dilation_cutoff_slip;
    }

    void take(const ContactBatch& q, int k) {
        contacts_.reaction[q.slot[k]] = {{q.fx[k], q.fy[k]}, q.torque_a[k], q.torque_b[k]};
        single_.work.friction += q.friction[k];
        single_.work.damping += q.damping[k];
        single_.work.released += q.released[k];
    }

    // ---- faces without intact bonds

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
        const Contact& c = list_[i];
        const Parts& parts = model_.parts;
        const auto next = [&](PartId p, int k) {
            return k + 1 == parts.first_corner[p + 1] ? parts.first_corner[p] : k + 1;
        };
        return {i,
                parts.block[c.part_a],
                parts.block[c.part_b],
                c.edge_a,
                next(c.part_a, c.edge_a),
                next(c.part_b, c.edge_b),
                c.edge_b,
                c.joint};
    }

    // What the next batch reads comes nearer while this one is computed.
    static void fetch(const FaceColumns& columns) {
        const char* begin = reinterpret_cast<const char*>(&columns);
        for (std::size_t line = 0; line < sizeof(FaceColumns); line += 64) __builtin_prefetch(begin + line, 1);
    }
    void fetch(const FaceSlot& f) const {
        __builtin_prefetch(&placed_.corner[f.a0]);
        __builtin_prefetch(&placed_.corner[f.a1]);
        __builtin_prefetch(&placed_.corner[f.b0]);
        __builtin_prefetch(&placed_.corner[f.b1]);
        __builtin_prefetch(&placed_.block[f.block_b]);
        __builtin_prefetch(&contacts_.reaction[f.slot], 1);
    }

    template <class Fetch>
    void compute_faces(std::span<const FaceSlot> faces, FaceColumns& columns, Fetch&& fetch_next) {
        const int count = faces_.count = static_cast<int>(faces.size());
        for (int k = 0; k < count; ++k) collect(faces[k], k);
        fetch_next();
        kernels_.faces(faces_, columns, dt_, damping_);
        for (int k = 0; k < count; ++k) {
            if (faces_.valid[k] != 0.0 && faces_.loaded[k] != 0.0)
                take(faces_, k);
            else
                compute_alone(k, columns);
        }
    }

    void collect(const FaceSlot& f, int k) {
        const PlacedCorner &a0 = placed_.corner[f.a0], &b1 = placed_.corner[f.b1];
        const Vec2 &a1 = placed_.corner[f.a1].arm, &b0 = placed_.corner[f.b0].arm;
        FaceBatch& q = faces_;
        q.a0x[k] = a0.arm.x(), q.a0y[k] = a0.arm.y(), q.a1x[k] = a1.x(), q.a1y[k] = a1.y();
        q.nax[k] = a0.normal.x(), q.nay[k] = a0.normal.y();
        q.b0x[k] = b0.x(), q.b0y[k] = b0.y(), q.b1x[k] = b1.arm.x(), q.b1y[k] = b1.arm.y();
        q.nbx[k] = b1.normal.x(), q.nby[k] = b1.normal.y();
        collect_common(q, k, f.slot, f.joint, f.block_a, f.block_b);
        if (!convex_) set_ends(k, list_[f.slot]);
    }

    void set_ends(int k, const Contact& c) {
        const Couple s = couple(model_, placed_, c);
        const FaceLines f = face_lines(s.a, s.b, s.dx, s.dy, c.edge_a - s.a.first, c.edge_b - s.b.first);
        faces_.a_lo[k] = f.a_lo, faces_.a_hi[k] = f.a_hi, faces_.b_lo[k] = f.b_lo, faces_.b_hi[k] = f.b_hi;
    }

    // Turned away, or open: other edges may touch.
    void compute_alone(int k, FaceColumns& columns) {
        const int i = faces_.slot[k];
        Contact& c = list_[i];
        columns.store(k, c);
        if (faces_.valid[k] != 0.0 && c.face >= 0) {
            single_.unload(i);
            note(i);
        } else {
            if (c.face >= 0) single_.end_face(i);
            c.edge_a = c.edge_b = -1;
            single_.changed = true;
            evaluate_single(i);
        }
        columns.load(k, c, model_.faces);
    }

    // ---- two corners in each other

    void collect(const CornerSlot& f) {
        CornerBatch& q = corners_;
        const int k = q.count++;
        const CornerLines l = corner_lines(placed_, f, 0.0, 0.0);
        q.ax[k] = l.ax, q.ay[k] = l.ay, q.na1x[k] = l.na1x, q.na1y[k] = l.na1y, q.na2x[k] = l.na2x, q.na2y[k] = l.na2y;
        q.bx[k] = l.bx, q.by[k] = l.by, q.nb1x[k] = l.nb1x, q.nb1y[k] = l.nb1y, q.nb2x[k] = l.nb2x, q.nb2y[k] = l.nb2y;
        q.reach[k] = l.reach, q.touch_depth[k] = l.touch_depth;
        const Contact& c = list_[f.slot];
        collect_common(q, k, f.slot, c.joint, f.block_a, f.block_b);
        q.load(k, c);
        if (q.count == CornerBatch::size) finish_corners();
    }

    void finish_corners() {
        CornerBatch& q = corners_;
        if (q.count == 0) return;
        kernels_.corners(q, dt_, damping_);
        const int count = std::exchange(q.count, 0);
        for (int k = 0; k < count; ++k) {
            if (q.valid[k] != 0.0) {
                Contact& c = list_[q.slot[k]];
                c.touching = 1;
                q.store(k, c);
                take(q, k);
            } else {
                single_.changed = true;
                evaluate_single(q.slot[k]);
            }
        }
    }

    const Model& model_;
    const Placed& placed_;
    double dt_, damping_;
    const State& state_;
    Contacts& contacts_;
    std::vector<Contact>& list_;
    const ContactIndex& index_;
    const Kernels kernels_;
    const bool convex_ = model_.parts.size() == model_.blocks.size();  // no block has an edge inside it
    FaceBatch& faces_;
    CornerBatch& corners_;
    SingleContacts single_;
    FaceTable* table_ = nullptr;           // of this chunk
    std::vector<int>* changed_ = nullptr;  // of this chunk
    Pace pace_ = Pace::all;
};

}  // namespace

Batches::Batches() {
    for (FaceBatch::Row* ends : {&faces.a_lo, &faces.a_hi, &faces.b_lo, &faces.b_hi}) std::ranges::fill(*ends, 1.0);
}

void update_contacts(const Model& model, const Placed& placed, double dt, Pace pace, State& state, ContactIndex& index) {
    static const Kernels kernels{face_kernel(best_vector_unit()), corner_kernel(best_vector_unit())};
    std::vector<FaceTable>& tables = state.contacts.list.tables();
    if (tables.empty())  // the list is new, or somebody has changed it
        for (ContactIndex::Chunk& chunk : index.chunks) chunk.sorted = false;
    tables.resize(index.chunks.size());
    // Chunks of slow contacts come first, if there are such.
    const int all = static_cast<int>(index.chunks.size());
    const int begin = pace == Pace::fast ? all / 2 : 0, chunks = pace == Pace::all ? all : all / 2;
    std::vector<ContactWork> work(chunks);
    index.batches.resize(threads_allowed());
    if (chunks == 1) {  // see core/parallel.hpp
        Evaluator(model, placed, dt, state, index, index.batches[0], kernels)(index.chunks[begin], tables[begin], work[0]);
    } else {
#pragma omp parallel
        {
            Evaluator evaluate(model, placed, dt, state, index, index.batches[thread_number()], kernels);
#pragma omp for schedule(dynamic)
            for (int k = 0; k < chunks; ++k) evaluate(index.chunks[begin + k], tables[begin + k], work[k]);
        }
    }
    state.contacts.list.fall_behind();
    for (const ContactWork& w : work) {
        state.ledger.friction += w.friction;
        state.ledger.contact_damping += w.damping;
        state.ledger.released += w.released;
    }
}

}  // namespace talus
