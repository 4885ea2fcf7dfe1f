#include "contact/contacts.hpp"

#include "contact/distance_potential.hpp"
#include "contact/face_path.hpp"
#include "contact/idle.hpp"
#include "contact/joint_memory.hpp"
#include "model/supports.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace talus {
namespace {

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

void make_incidence(const Model& model, const Contacts& contacts, ContactIndex& index) {
    const int nb = model.blocks.size(), n = static_cast<int>(contacts.list.size());
    index.first.assign(nb + 1, 0);
    index.entry.resize(2 * static_cast<std::size_t>(n));
    for (const Contact& c : contacts.list) {
        ++index.first[model.parts.block[c.part_a] + 1];
        ++index.first[model.parts.block[c.part_b] + 1];
    }
    for (int b = 0; b < nb; ++b) index.first[b + 1] += index.first[b];
    std::vector<int> place(index.first.begin(), index.first.end() - 1);
    for (int i = 0; i < n; ++i) {
        index.entry[place[model.parts.block[contacts.list[i].part_a]]++] = 2 * i;
        index.entry[place[model.parts.block[contacts.list[i].part_b]]++] = 2 * i + 1;
    }
}

// Idle places in `idle`, the others are alive.
void make_chunks(const Model& model, const Contacts& contacts, std::span<const Idle> idle, ContactIndex& index) {
    constexpr int blocks_per_chunk = 256;  // fixed, so that sums do not depend on the number of threads
    const int n = static_cast<int>(contacts.list.size());
    index.chunks.assign((model.blocks.size() + blocks_per_chunk - 1) / blocks_per_chunk, {n, n, {}, {}});
    auto next_idle = idle.begin();
    for (int i = 0; i < n; ++i) {
        const int k = model.parts.block[contacts.list[i].part_a] / blocks_per_chunk;
        ContactIndex::Chunk& chunk = index.chunks[k];
        chunk.begin = std::min(chunk.begin, i);
        chunk.end = i + 1;
        if (next_idle != idle.end() && next_idle->slot == i)
            chunk.idle.push_back(*next_idle++);
        else
            chunk.alive.push_back(i);
    }
}

}  // namespace

double memory_reach(const Model& model, PartId a, PartId b) {
    return 0.01 * std::min(model.parts.thickness[a], model.parts.thickness[b]);
}

double touch_depth(const Model& model, PartId a, PartId b) { return 1e-10 * memory_reach(model, a, b); }

void refresh_contacts(const Model& model, const Placed& placed, std::span<const Pair> pairs, double skin, State& state,
                      ContactIndex& index) {
    const Contacts& old = state.contacts;
    const Movable movable(model, state);
    std::vector<Contact> list;
    std::vector<Reaction> reaction;
    std::vector<Idle> idle;
    index.skin = skin;
    std::size_t i = 0;
    const auto keep = [&](std::size_t k) {
        const Contact& c = old.list[k];
        if (!c.alive || !movable(c.part_a, c.part_b)) return;
        list.push_back(c);
        reaction.push_back(old.reaction[k]);
    };
    for (const Pair& pair : pairs) {
        while (i < old.list.size() && key_less(old.list[i], pair)) keep(i++);
        if (i < old.list.size() && old.list[i].part_a == pair.a && old.list[i].part_b == pair.b && old.list[i].alive) {
            keep(i++);
            continue;
        }
        if (!movable(pair.a, pair.b)) continue;
        const PlacedPart a(model, placed, pair.a), b(model, placed, pair.b);
        const Vec2 d = placed.block[model.parts.block[pair.b]].position - placed.block[model.parts.block[pair.a]].position;
        const Separation separate = separation(a, b, d.x(), d.y());
        Apart apart;
        if (separate.distance >= -touch_depth(model, pair.a, pair.b))
            apart = keep_apart(model, placed, pair.a, pair.b, separate, skin);
        if (apart.never) continue;
        idle.push_back(apart.idle);
        idle.back().slot = static_cast<int>(list.size());
        list.push_back(Contact{pair.a, pair.b, model.joint_between(pair.a, pair.b)});
        reaction.emplace_back();
    }
    while (i < old.list.size()) keep(i++);
    list.shrink_to_fit();
    reaction.shrink_to_fit();
    state.contacts.list = std::move(list);
    state.contacts.reaction = std::move(reaction);
    make_incidence(model, state.contacts, index);
    make_chunks(model, state.contacts, idle, index);
}

void sum_contacts(const Model& model, const Contacts& contacts, const ContactIndex& index, std::span<Force> load) {
    const int nb = model.blocks.size();
#pragma omp parallel for schedule(static)
    for (int b = 0; b < nb; ++b) {
        double fx = 0.0, fy = 0.0, torque = 0.0;
        for (int e = index.first[b]; e < index.first[b + 1]; ++e) {
            const int i = index.entry[e] >> 1;
            const Reaction& r = contacts.reaction[i];
            const bool on_b = index.entry[e] & 1;
            fx += on_b ? r.force.x() : -r.force.x();
            fy += on_b ? r.force.y() : -r.force.y();
            torque += on_b ? r.torque_b : r.torque_a;
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
            const FaceMemory memory = joint_memory(face, joint, state.contacts.broken);
            energy.normal +=
                joint.kn * face_energy(a, b, d.x(), d.y(), face.edge_a - a.first, face.edge_b - b.first, &memory);
        }
    }
    return energy;
}

}  // namespace talus
