#include "rigid/bodies.hpp"

#include "core/errors.hpp"
#include "core/parallel.hpp"
#include "core/text.hpp"
#include "core/turn.hpp"
#include "model/title.hpp"

#include <algorithm>
#include <numeric>

namespace talus::rigid {
namespace {

constexpr int few = 1000;  // bodies: one thread has done them by the time that a second one has woken

class Sets {  // of blocks that belong together, each named by its smallest member
public:
    explicit Sets(int n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
    int of(int i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(int i, int j) {
        i = of(i), j = of(j);
        parent_[std::max(i, j)] = std::min(i, j);
    }

private:
    std::vector<int> parent_;
};

constexpr const char* remedy = "; give its contacts a joint without cohesion and tension, or use solver: explicit";

// What is held or driven along all axes takes along all that is bonded to it.
BlockId driver_of(const Model& model, std::span<const BlockId> members) {
    BlockId driver = -1, held = -1;
    for (const BlockId b : members) {
        const Blocks& blocks = model.blocks;
        const bool free = blocks.inv_mass[b].x() > 0.0 && blocks.inv_mass[b].y() > 0.0 && blocks.inv_inertia[b] > 0.0;
        if (free) continue;
        if (!blocks.held(b))
            throw InputError("the rigid solver cannot bond a block that is held or driven along some axes only to others: " +
                             title_and_place(model, b) + remedy);
        const bool drives = std::ranges::any_of(
            model.driven, [&](const DrivenBlock& d) { return d.block == b && (d.x || d.y || d.rotation); });
        BlockId& mine = drives ? driver : held;
        if (drives && driver >= 0)
            throw InputError("the rigid solver cannot bond blocks that are both driven: " + title_and_place(model, driver) +
                             " and " + title_and_place(model, b) + remedy);
        mine = b;
    }
    if (driver >= 0 && held >= 0)
        throw InputError("the rigid solver cannot bond a block that is driven to one that is held: " +
                         title_and_place(model, driver) + " and " + title_and_place(model, held) + remedy);
    return driver;
}

Softness softness_of(const Model& model, std::span<const BlockId> members) {
    const Blocks& blocks = model.blocks;
    if (members.size() == 1) {
        const BlockId b = members.front();
        return {blocks.inv_mass[b].x(), blocks.inv_mass[b].y(), blocks.inv_inertia[b]};
    }
    double mass = 0.0, inertia = 0.0;
    Vec2 centre = Vec2::Zero();
    for (const BlockId b : members) {
        if (blocks.held(b)) return {};
        mass += blocks.mass[b];
        centre += blocks.mass[b] * (blocks.start[b] - blocks.start[members.front()]);
    }
    centre /= mass;
    for (const BlockId b : members)
        inertia +=
            blocks.inertia[b] + blocks.mass[b] * (blocks.start[b] - blocks.start[members.front()] - centre).squaredNorm();
    return {1.0 / mass, 1.0 / mass, 1.0 / inertia};
}

}  // namespace

Velocity seen_from(const Motion& motion, BlockId block, const Vec2& point) {
    const double spin = motion.spin[block];
    const Vec2 v = motion.velocity[block] + spin * perp(point - motion.position[block]);
    return {v.x(), v.y(), spin};
}

double intact_length(const Model& model, const State& state, const Contact& c) {
    if (c.face < 0 || !model.faces[c.face].bonded) return 0.0;
    const JointFace& face = model.faces[c.face];
    const int cells = model.joints[face.joint].cells;
    const auto first = state.contacts.broken.begin() + face.first_cell;
    return (face.s1 - face.s0) * static_cast<double>(std::count(first, first + cells, 0)) / cells;
}

bool holds(const Model& model, const State& state, const Contact& c) {
    return !c.slipped && intact_length(model, state, c) > 0.0;
}

Bodies join_bonded(const Model& model, const State& state) {
    const int nb = model.blocks.size();
    Sets sets(nb);
    for (const Contact& c : state.contacts.list) {
        const BlockId a = model.parts.block[c.part_a], b = model.parts.block[c.part_b];
        if (!state.removed[a] && !state.removed[b] && holds(model, state, c)) sets.join(a, b);
    }
    Bodies bodies;
    bodies.body_of.resize(nb);
    int nq = 0;
    for (BlockId b = 0; b < nb; ++b) bodies.body_of[b] = sets.of(b) == b ? nq++ : bodies.body_of[sets.of(b)];
    bodies.first.assign(nq + 1, 0);
    for (const int q : bodies.body_of) ++bodies.first[q + 1];
    std::partial_sum(bodies.first.begin(), bodies.first.end(), bodies.first.begin());
    bodies.member.resize(nb);
    std::vector<int> next(bodies.first.begin(), bodies.first.end() - 1);
    for (BlockId b = 0; b < nb; ++b) bodies.member[next[bodies.body_of[b]]++] = b;
    bodies.position.resize(nq);
    bodies.velocity.resize(nq);
    for (int q = 0; q < nq; ++q) {
        const auto members =
            std::span<const BlockId>(bodies.member).subspan(bodies.first[q], bodies.first[q + 1] - bodies.first[q]);
        bodies.driver.push_back(members.size() > 1 ? driver_of(model, members) : -1);
        bodies.softness.push_back(softness_of(model, members));
    }
    return bodies;
}

void gather(const Model& model, const Motion& motion, Bodies& bodies) {
    const int nq = bodies.size();
    for_all(nq, few, [&](int q) {
        const BlockId lead = bodies.member[bodies.first[q]];
        const Vec2 start = motion.position[lead];
        if (bodies.single(q)) {
            bodies.position[q] = start;
            bodies.velocity[q] = {motion.velocity[lead].x(), motion.velocity[lead].y(), motion.spin[lead]};
            return;
        }
        double mass = 0.0;
        Vec2 centre = Vec2::Zero(), momentum = Vec2::Zero();
        for (int i = bodies.first[q]; i < bodies.first[q + 1]; ++i) {
            const BlockId b = bodies.member[i];
            mass += model.blocks.mass[b];
            centre += model.blocks.mass[b] * (motion.position[b] - start);
            momentum += model.blocks.mass[b] * motion.velocity[b];
        }
        centre /= mass;
        bodies.position[q] = start + centre;
        if (const BlockId driver = bodies.driver[q]; driver >= 0) {
            bodies.velocity[q] = seen_from(motion, driver, bodies.position[q]);
            return;
        }
        double spin = 0.0;  // from the moment of momentum: blocks that have just been joined may differ
        for (int i = bodies.first[q]; i < bodies.first[q + 1]; ++i) {
            const BlockId b = bodies.member[i];
            spin += model.blocks.inertia[b] * motion.spin[b] +
                    model.blocks.mass[b] * cross(motion.position[b] - start - centre, motion.velocity[b]);
        }
        const Softness& soft = bodies.softness[q];
        bodies.velocity[q] = {momentum.x() * soft.x, momentum.y() * soft.y, spin * soft.spin};
    });
}

void drift(const Bodies& bodies, double dt, Motion& motion, std::span<const Velocity> velocity) {
    const int nq = bodies.size();
    for_all(nq, few, [&](int q) {
        const Velocity& v = velocity[q];
        const Vec2 moved(v.x * dt, v.y * dt);
        const double turned = v.spin * dt;
        if (bodies.single(q)) {
            const BlockId b = bodies.member[bodies.first[q]];
            motion.position[b] += moved;
            motion.angle[b] += turned;
            return;
        }
        const Turn full = turn(turned), half = turn(0.5 * turned);
        for (int i = bodies.first[q]; i < bodies.first[q + 1]; ++i) {
            const BlockId b = bodies.member[i];
            const Vec2 arm = motion.position[b] - bodies.position[q];
            // (R - 1) arm, without the difference of two large numbers
            motion.position[b] += moved + full.s * perp(arm) - 2.0 * half.s * half.s * arm;
            motion.angle[b] += turned;
        }
    });
}

void scatter(const Bodies& bodies, Motion& motion) {
    const int nq = bodies.size();
    for_all(nq, few, [&](int q) {
        const Velocity& v = bodies.velocity[q];
        for (int i = bodies.first[q]; i < bodies.first[q + 1]; ++i) {
            const BlockId b = bodies.member[i];
            motion.velocity[b] = Vec2(v.x, v.y) + v.spin * perp(motion.position[b] - bodies.position[q]);
            motion.spin[b] = v.spin;
        }
    });
}

}  // namespace talus::rigid
