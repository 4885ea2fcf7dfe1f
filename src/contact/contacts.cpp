#include "contact/contacts.hpp"

#include "contact/distance_potential.hpp"
#include "contact/face_path.hpp"
#include "contact/idle.hpp"
#include "contact/joint_memory.hpp"
#include "contact/rounded_corners.hpp"
#include "core/parallel.hpp"
#include "model/part_boxes.hpp"
#include "model/supports.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace talus {
namespace {

constexpr int blocks_per_chunk = 256;  // fixed, so that sums do not depend on the number of threads

int chunks_of(const Model& model) { return (model.blocks.size() + blocks_per_chunk - 1) / blocks_per_chunk; }

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

// What the new list will hold at one place.
struct Entry {
    int from;  // slot in the old list, -1 = none
    PartId part_a, part_b;
};

// The new list of one chunk of blocks, before it is known where it begins: slots count from 0.
class ChunkPlan {
public:
    std::vector<Entry> entries;
    std::vector<Idle> idle;

    void keep(int from, const Contact& c) { entries.push_back({from, c.part_a, c.part_b}); }
    void keep_idle(int from, const Pair& pair, const Idle& known) {
        idle.push_back(known);
        idle.back().slot = static_cast<int>(entries.size());
        entries.push_back({from, pair.a, pair.b});
    }
};

class Refresh {
public:
    Refresh(const Model& model, const Placed& placed, std::span<const Pair> pairs, std::span<const std::uint8_t> reboxed,
            const State& state, const ContactIndex& index)
        : model_(model),
          placed_(placed),
          pairs_(pairs),
          reboxed_(reboxed),
          old_(state.contacts.list.read()),
          index_(index),
          movable_(model, state) {}

    ChunkPlan plan(int chunk) const {
        const BlockId begin = chunk * blocks_per_chunk, end = std::min(begin + blocks_per_chunk, model_.blocks.size());
        const PartId first = model_.blocks.first_part[begin], last = model_.blocks.first_part[end];
        const auto pair = std::ranges::lower_bound(pairs_, first, {}, &Pair::a);
        const auto pairs_end = std::ranges::lower_bound(pair, pairs_.end(), last, {}, &Pair::a);
        int i = slot_of(first);
        const int slots_end = slot_of(last);
        ChunkPlan plan;
        std::span<const Idle> known[2];  // of as many paces
        for (std::size_t k = chunk, pace = 0; k < index_.chunks.size(); k += chunks_of(model_))
            known[pace++] = index_.chunks[k].idle;
        const auto keep_alive = [&](int slot) {
            const Contact& c = old_[slot];
            if (c.alive && movable_(c.part_a, c.part_b)) plan.keep(slot, c);
        };
        for (const Pair& p : std::ranges::subrange(pair, pairs_end)) {
            while (i < slots_end && key(old_[i]) < p) keep_alive(i++);
            const int from = i < slots_end && key(old_[i]) == p ? i++ : -1;
            if (from >= 0 && old_[from].alive)
                keep_alive(from);
            else if (reboxed_[model_.parts.block[p.a]] || reboxed_[model_.parts.block[p.b]])
                look_at(from, p, plan);
            else if (from >= 0)
                plan.keep_idle(from, p, idle_of(from, known));
        }
        while (i < slots_end) keep_alive(i++);
        return plan;
    }

private:
    static Pair key(const Contact& c) { return {c.part_a, c.part_b}; }
    int slot_of(PartId part) const {
        return static_cast<int>(std::ranges::lower_bound(old_, part, {}, &Contact::part_a) - old_.begin());
    }

    static Idle idle_of(int slot, std::span<const Idle> (&known)[2]) {
        for (std::span<const Idle>& of_pace : known) {
            while (!of_pace.empty() && of_pace.front().slot < slot) of_pace = of_pace.subspan(1);
            if (!of_pace.empty() && of_pace.front().slot == slot) return of_pace.front();
        }
        return {};
    }

    void look_at(int from, const Pair& p, ChunkPlan& plan) const {
        if (!movable_(p.a, p.b)) return;
        const PlacedPart a(model_, placed_, p.a), b(model_, placed_, p.b);
        const Vec2 d = placed_.block[model_.parts.block[p.b]].position - placed_.block[model_.parts.block[p.a]].position;
        const Separation separate = separation(a, b, d.x(), d.y());
        Apart apart;
        if (separate.distance >= -touch_depth(model_, p.a, p.b))
            apart = keep_apart(model_, placed_, p.a, p.b, separate, (1.0 + kept_share) * index_.skin);
        if (!apart.never) plan.keep_idle(from, p, apart.idle);
    }

    const Model& model_;
    const Placed& placed_;
    std::span<const Pair> pairs_;
    std::span<const std::uint8_t> reboxed_;
    const std::vector<Contact>& old_;
    const ContactIndex& index_;
    const Movable movable_;
};

// Where the contacts of each block are. Threads fill the places of a block in any order; sorting them puts that right.
void make_incidence(const Model& model, const std::vector<Contact>& list, ContactIndex& index) {
    const int nb = model.blocks.size(), n = static_cast<int>(list.size());
    index.first_a.assign(nb + 1, 0);
    index.first_b.assign(nb + 1, 0);
    index.slot_b.resize(n);
    const auto block_b = [&](int i) { return model.parts.block[list[i].part_b]; };
#pragma omp parallel for schedule(static)
    for (int i = 0; i < n; ++i) {
#pragma omp atomic
        ++index.first_a[model.parts.block[list[i].part_a] + 1];
#pragma omp atomic
        ++index.first_b[block_b(i) + 1];
    }
    std::partial_sum(index.first_a.begin(), index.first_a.end(), index.first_a.begin());
    std::partial_sum(index.first_b.begin(), index.first_b.end(), index.first_b.begin());
    std::vector<int> next(index.first_b.begin(), index.first_b.end() - 1);
#pragma omp parallel for schedule(static)
    for (int i = 0; i < n; ++i) {
        int at;
#pragma omp atomic capture
        at = next[block_b(i)]++;
        index.slot_b[at] = i;
    }
#pragma omp parallel for schedule(static)
    for (int b = 0; b < nb; ++b)
        std::sort(index.slot_b.begin() + index.first_b[b], index.slot_b.begin() + index.first_b[b + 1]);
}

template <class Visit>
void for_each_neighbour(const Model& model, const Contacts& contacts, const ContactIndex& index, BlockId b, Visit&& visit) {
    if (index.chunks.empty()) return;
    for (int i = index.first_a[b]; i < index.first_a[b + 1]; ++i) visit(model.parts.block[contacts.list.key(i).part_b]);
    for (int e = index.first_b[b]; e < index.first_b[b + 1]; ++e)
        visit(model.parts.block[contacts.list.key(index.slot_b[e]).part_a]);
}

}  // namespace

bool remembers(const Model& model, const Contact& contact) {
    if (contact.face >= 0) return true;
    const Joint& joint = model.joints[contact.joint];
    return contact.slipped && (joint.weakens || joint.tan_dilation > 0.0);
}

double memory_reach(const Model& model, PartId a, PartId b) {
    return 0.01 * std::min(model.parts.thickness[a], model.parts.thickness[b]);
}

double touch_depth(const Model& model, PartId a, PartId b) { return 1e-10 * memory_reach(model, a, b); }

void refresh_contacts(const Model& model, const Placed& placed, std::span<const Pair> pairs,
                      std::span<const std::uint8_t> reboxed, double skin, State& state, ContactIndex& index) {
    index.skin = skin;
    const int chunks = chunks_of(model);
    const Refresh refresh(model, placed, pairs, reboxed, state, index);
    std::vector<ChunkPlan> plans(chunks);
#pragma omp parallel for schedule(dynamic)
    for (int k = 0; k < chunks; ++k) plans[k] = refresh.plan(k);

    const int paces = state.fast.empty() ? 1 : 2;
    index.chunks.resize(paces * chunks);
    int n = 0;
    for (int k = 0; k < chunks; ++k) {
        index.chunks[k].begin = n;
        index.chunks[k].end = n += static_cast<int>(plans[k].entries.size());
        index.chunks[k].pace = paces == 1 ? Pace::all : Pace::slow;
        if (paces == 1) continue;
        ContactIndex::Chunk& fast = index.chunks[k + chunks];
        fast.begin = index.chunks[k].begin, fast.end = n, fast.pace = Pace::fast, fast.sorted = false;
    }
    const std::vector<Contact>& old = state.contacts.list.read();
    std::vector<Contact> list(n);
    std::vector<Reaction> reaction(n);
#pragma omp parallel for schedule(dynamic)
    for (int k = 0; k < chunks; ++k) {
        ContactIndex::Chunk& chunk = index.chunks[k];
        chunk.sorted = false;
        chunk.idle = std::move(plans[k].idle);
        for (Idle& idle : chunk.idle) idle.slot += chunk.begin;
        if (paces == 2) index.chunks[k + chunks].idle = chunk.idle;
        for (int i = chunk.begin; i < chunk.end; ++i) {
            const Entry& e = plans[k].entries[i - chunk.begin];
            if (e.from >= 0) {
                list[i] = old[e.from];
                reaction[i] = state.contacts.reaction[e.from];
            } else {
                list[i] = {.part_a = e.part_a, .part_b = e.part_b, .joint = model.joint_between(e.part_a, e.part_b)};
            }
        }
    }
    state.contacts.list.edit() = std::move(list);
    state.contacts.reaction = std::move(reaction);
    make_incidence(model, state.contacts.list.read(), index);
}

void sort_contacts_again(const Model& model, const Contacts& contacts, BlockId block, ContactIndex& index) {
    if (index.chunks.empty()) return;
    const auto mark = [&](BlockId a, int slot) {  // of every pace
        for (std::size_t k = a / blocks_per_chunk; k < index.chunks.size(); k += chunks_of(model))
            index.chunks[k].changed.push_back(slot);
    };
    for (int i = index.first_a[block]; i < index.first_a[block + 1]; ++i) mark(block, i);
    for (int e = index.first_b[block]; e < index.first_b[block + 1]; ++e)
        mark(model.parts.block[contacts.list.key(index.slot_b[e]).part_a], index.slot_b[e]);
}

void find_rest(const Model& model, const State& state, const ContactIndex& index, std::span<const BlockId> changed,
               std::span<Rest> rest) {
    const auto rest_of = [&](BlockId b) {
        if (!state.frozen(b)) return Rest::moving;
        bool loaded = false;
        for_each_neighbour(model, state.contacts, index, b, [&](BlockId other) { loaded |= !state.frozen(other); });
        return loaded ? Rest::loaded : Rest::resting;
    };
    const bool all = changed.size() == rest.size();
    for (const BlockId b : changed) {
        rest[b] = rest_of(b);
        if (all) continue;
        for_each_neighbour(model, state.contacts, index, b, [&](BlockId other) {
            if (rest[other] != Rest::moving) rest[other] = rest_of(other);
        });
    }
    for (const Load& load : model.loads)
        if (rest[load.block] == Rest::resting) rest[load.block] = Rest::loaded;
}

void sum_contacts(std::span<const BlockRange> ranges, const Contacts& contacts, const ContactIndex& index,
                  std::span<Force> load) {
    for_all(static_cast<int>(ranges.size()), 1, [&](int k) {
        for (int b = ranges[k].begin; b < ranges[k].end; ++b) {
            double fx = 0.0, fy = 0.0, torque = 0.0;
            for (int e = index.first_b[b]; e < index.first_b[b + 1]; ++e) {
                const Reaction& r = contacts.reaction[index.slot_b[e]];
                fx += r.force.x();
                fy += r.force.y();
                torque += r.torque_b;
            }
            for (int i = index.first_a[b]; i < index.first_a[b + 1]; ++i) {
                const Reaction& r = contacts.reaction[i];
                fx -= r.force.x();
                fy -= r.force.y();
                torque += r.torque_a;
            }
            load[b].force += Vec2(fx, fy);
            load[b].torque += torque;
        }
    });
}

double handed_on(const Contacts& contacts, const ContactIndex& index, BlockId block) {
    double sum = 0.0;
    for (int e = index.first_b[block]; e < index.first_b[block + 1]; ++e)
        sum += contacts.reaction[index.slot_b[e]].force.norm();
    for (int i = index.first_a[block]; i < index.first_a[block + 1]; ++i) sum += contacts.reaction[i].force.norm();
    return 0.5 * sum;
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
        if (model.rounding_length > 0.0) {
            energy.normal += joint.kn * rounded_energy(model, a, b, d.x(), d.y());
        } else if (c.edge_a < 0 || c.edge_b < 0) {
            energy.normal += joint.kn * distance_potential_energy(a, b, d.x(), d.y());
        } else if (c.face < 0) {
            energy.normal += joint.kn * face_energy(a, b, d.x(), d.y(), c.edge_a - a.first, c.edge_b - b.first, nullptr);
        } else {
            const JointFace& face = model.faces[c.face];
            const FaceMemory memory = joint_memory(face, joint, state.contacts.broken);
            energy.normal +=
                joint.kn * face_energy(a, b, d.x(), d.y(), face.edge_a - a.first, face.edge_b - b.first, &memory);
        }
    }
    return energy;
}

}  // namespace talus
