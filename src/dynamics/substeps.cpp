#include "dynamics/substeps.hpp"

#include "core/parallel.hpp"
#include "dynamics/motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace {

template <class Is>
std::vector<BlockRange> ranges_where(int blocks, Is&& is) {
    std::vector<Rest> kinds(blocks);
    for (BlockId b = 0; b < blocks; ++b) kinds[b] = is(b) ? Rest::moving : Rest::resting;
    return awake(kinds).moving;
}

template <class Visit>
void for_each(std::span<const BlockRange> ranges, Visit&& visit) {
    for (const BlockRange& range : ranges)
        for (BlockId b = range.begin; b < range.end; ++b) visit(b);
}

// [nb] slow blocks that the list pairs with a fast one; `touching`: that carry force, too.
std::vector<std::uint8_t> neighbours_of_fast(const Model& model, const State& state, std::span<const std::uint8_t> fast,
                                             bool touching) {
    std::vector<std::uint8_t> near(fast.size(), 0);
    for (const Contact& c : state.contacts.list) {
        const BlockId a = model.parts.block[c.part_a], b = model.parts.block[c.part_b];
        if ((touching && !c.touching) || fast[a] == fast[b]) continue;
        near[fast[a] ? b : a] = 1;
    }
    return near;
}

struct BlockWork {  // of one range, J, and its largest speed, m/s
    double all = 0.0, gravity = 0.0, damping = 0.0, loads = 0.0, driven = 0.0, speed = 0.0;
};

// Adds the work of a kick along one axis; `mean`: velocity in the middle of it, m/s.
struct Axis {
    double inverse, mean, dt;
    void add(double force, double weight, double release, double damping, BlockWork& work) const {
        const double way = dt * mean;
        if (inverse == 0.0) {
            work.driven -= way * (force - weight);
            return;
        }
        work.all += way * force;
        work.gravity += way * weight;
        work.loads += way * release;
        work.damping += way * damping;
    }
};

// m/s and rad/s, in the middle of a kick.
struct Mean {
    Vec2 velocity;
    double spin;
};
Mean mean_of_kick(const Blocks& blocks, BlockId b, const Force& load, const Motion& motion, double dt) {
    return {motion.velocity[b] + 0.5 * dt * load.force.cwiseProduct(blocks.inv_mass[b]),
            motion.spin[b] + 0.5 * dt * load.torque * blocks.inv_inertia[b]};
}

void add_kick(const Blocks& blocks, BlockId b, const Force& load, double dt, Motion& motion) {
    motion.velocity[b] += dt * load.force.cwiseProduct(blocks.inv_mass[b]);
    motion.spin[b] += dt * load.torque * blocks.inv_inertia[b];
}

double work_of_loads(const Model& model, const HalfKick& half, const State& state) {
    double work = 0.0;
    for (const Load& l : model.loads) {
        if (state.is_fast(l.block) != half.fast || half.without_external(l.block)) continue;
        const Mean mean = mean_of_kick(model.blocks, l.block, half.load[l.block], state.motion, half.dt);
        const Force f = load_at(l, half.time, state.motion.angle[l.block]);
        const Vec2& free = model.blocks.inv_mass[l.block];
        if (free.x() != 0.0) work += half.dt * mean.velocity.x() * f.force.x();
        if (free.y() != 0.0) work += half.dt * mean.velocity.y() * f.force.y();
        if (model.blocks.inv_inertia[l.block] != 0.0) work += half.dt * mean.spin * f.torque;
    }
    return work;
}

}  // namespace

Substeps substeps_for(const Model& model, const State& state, std::span<const double> limits, int count, double step,
                      double share) {
    const int nb = model.blocks.size();
    Substeps found{count, std::vector<std::uint8_t>(nb, 0), 1.0};
    double blocks = 0.0, fast_blocks = 0.0, contacts = 0.0, fast_contacts = 0.0;
    for (BlockId b = 0; b < nb; ++b) found.fast[b] = step > share * limits[b];
    const std::vector<std::uint8_t> near = neighbours_of_fast(model, state, found.fast, true);
    bool any_slow = false;
    for (BlockId b = 0; b < nb; ++b) {
        if (std::isinf(limits[b])) continue;
        blocks += 1.0;
        fast_blocks += found.fast[b] || near[b];
        any_slow |= !found.fast[b];
    }
    for (const Contact& c : state.contacts.list) {
        if (!c.touching) continue;
        contacts += 1.0;
        fast_contacts += found.fast[model.parts.block[c.part_a]] || found.fast[model.parts.block[c.part_b]];
    }
    if (!any_slow || fast_blocks == 0.0) return {};
    const double without = count * (blocks + contacts);
    found.gain = without / (blocks + contacts + (count - 1) * (fast_blocks + fast_contacts));
    return found;
}

Substeps substeps_of_step(const Model& model, const State& state, std::span<const double> limits, int asked, double step,
                          double fraction) {
    const double bound = limits.empty() ? step : *std::ranges::min_element(limits);
    int count = asked;
    if (asked == 0)
        for (count = 1; count < most_substeps && step > count * fraction * bound;) count *= 2;
    return count == 1 ? Substeps{} : substeps_for(model, state, limits, count, step, std::min(slow_share, fraction));
}

ChosenSubsteps choose_substeps(const Model& model, const State& state, std::span<const double> limits, double step,
                               double share) {
    ChosenSubsteps best{{}, step};
    for (int count = 2; count <= most_substeps; count *= 2) {
        Substeps with = substeps_for(model, state, limits, count, count * step, share);
        if (with.gain < worth_substeps || with.gain <= best.substeps.gain) continue;
        best = {std::move(with), count * step};
    }
    return best;
}

// ---- who is concerned -----------------------------------------------------------------------------------------------

void Paces::mark(const Model& model, const State& state, std::span<const std::uint8_t> near) {
    const int nb = model.blocks.size();
    fast_.moving = ranges_where(nb, [&](BlockId b) { return !state.frozen(b) && state.fast[b]; });
    slow_ = ranges_where(nb, [&](BlockId b) { return !state.frozen(b) && !state.fast[b]; });
    others_ = ranges_where(nb, [&](BlockId b) { return !state.frozen(b) && !state.fast[b] && !near[b]; });
    inner_.moving = ranges_where(nb, [&](BlockId b) { return !state.frozen(b) && (state.fast[b] || near[b]); });
    known_ = true;
}

void Paces::find(const Model& model, const State& state) {
    const std::vector<std::uint8_t> near = neighbours_of_fast(model, state, state.fast, false);
    mark(model, state, near);
    near_.clear();
    for_each(slow_, [&](BlockId b) {
        if (near[b]) near_.push_back({.position = Vec2::Zero(), .angle = 0.0, .block = b, .since = 0});
    });
    find_pulls(model, state);
}

void Paces::find_pulls(const Model& model, const State& state) {
    line_of_.assign(model.blocks.size(), -1);
    carried_.resize(model.blocks.size());
    for (std::size_t k = 0; k < near_.size(); ++k) {
        line_of_[near_[k].block] = static_cast<int>(k);
        near_[k].first_pull = 0;
    }
    const auto for_each_pull = [&](auto&& visit) {
        int slot = 0;
        for (const Contact& c : state.contacts.list) {
            const BlockId a = model.parts.block[c.part_a], b = model.parts.block[c.part_b];
            if (state.fast[a] && line_of_[b] >= 0) visit(near_[line_of_[b]], Pull{slot, true});
            if (state.fast[b] && line_of_[a] >= 0) visit(near_[line_of_[a]], Pull{slot, false});
            ++slot;
        }
    };
    for_each_pull([](Line& of, const Pull&) { ++of.first_pull; });
    int end = 0;
    for (Line& of : near_) of.first_pull = end += of.first_pull;
    pulls_.resize(end);
    for_each_pull([&](Line& of, const Pull& pull) { pulls_[--of.first_pull] = pull; });
    for (std::size_t k = 0; k < near_.size(); ++k) {
        const int next = k + 1 < near_.size() ? near_[k + 1].first_pull : end;
        std::reverse(pulls_.begin() + near_[k].first_pull, pulls_.begin() + next);
    }
}

void Paces::all_become_near(const Model& model, const State& state, int parts) {
    for_each(others_, [&](BlockId b) {
        near_.push_back({.position = state.motion.position[b],
                         .way = parts * state.motion.velocity[b],
                         .angle = state.motion.angle[b],
                         .turn = parts * state.motion.spin[b],
                         .block = b,
                         .since = parts});
    });
    std::ranges::sort(near_, {}, &Line::block);
    mark(model, state, std::vector<std::uint8_t>(model.blocks.size(), 1));
    known_ = false;  // at the next step it may be few again
}

// ---- where they are -------------------------------------------------------------------------------------------------

void Paces::begin_step(const Model& model, const State& state) {
    std::ranges::fill(carried_, 0);
    sum_pulls(model, state);
    for (Line& line : near_) {
        carried_[line.block] = line.pulls();
        line.since = 0;
        line.position = state.motion.position[line.block];
        line.angle = state.motion.angle[line.block];
        line.way.setZero();
        line.turn = 0.0;
    }
    sum_pulls(model, state);
}

bool Paces::others_stay(const Model& model, const Motion& motion, const Placed& placed, double skin, double dt) const {
    bool stay = true;
    for_each(others_, [&](BlockId b) {
        const Vec2 to = motion.position[b] + dt * motion.velocity[b];
        stay &= placed.boxed[b].moved(to, motion.angle[b] + dt * motion.spin[b], model.box_axis) <= skin;
    });
    return stay;
}

void Paces::move_near(int parts, double part, Motion& motion) const {
    for (const Line& line : near_) {
        const double since = (parts - line.since) * part;
        motion.position[line.block] = line.position + since * motion.velocity[line.block];
        motion.angle[line.block] = line.angle + since * motion.spin[line.block];
    }
}

void Paces::move_others(double dt, Motion& motion) const { drift({others_, {}, {}}, motion, dt); }

void Paces::place_means(const Motion& motion, int parts, Placed& placed) const {
    for (const Line& line : near_) {
        const BlockId b = line.block;
        placed.block[b].velocity = (line.way + (parts - line.since) * motion.velocity[b]) / parts;
        placed.block[b].spin = (line.turn + (parts - line.since) * motion.spin[b]) / parts;
    }
}

// ---- what moves them ------------------------------------------------------------------------------------------------

void Paces::sum_pulls(const Model& model, const State& state) {
    const Vec2 g(model.gravity_x(state.stage_time), model.gravity_y(state.stage_time));
    const double share = state.release.empty() ? 0.0 : release_share(model, state.stage_time);
    for (std::size_t k = 0; k < near_.size(); ++k) {
        const int end = k + 1 < near_.size() ? near_[k + 1].first_pull : static_cast<int>(pulls_.size());
        Line& line = near_[k];
        line.pull = line.external = {};
        for (int i = line.first_pull; i < end; ++i) {
            const Reaction& r = state.contacts.reaction[pulls_[i].slot];
            line.pull.force += pulls_[i].on_b ? r.force : Vec2(-r.force);
            line.pull.torque += pulls_[i].on_b ? r.torque_b : r.torque_a;
        }
        if (!carried_[line.block]) continue;
        line.weight = model.blocks.mass[line.block] * g;
        line.external.force = line.weight;
        if (share == 0.0) continue;
        line.external.force += share * state.release[line.block].force;
        line.external.torque += share * state.release[line.block].torque;
    }
    for (const Load& l : model.loads) {
        if (line_of_[l.block] < 0 || !carried_[l.block]) continue;
        const Force f = load_at(l, state.stage_time, state.motion.angle[l.block]);
        near_[line_of_[l.block]].external.force += f.force;
        near_[line_of_[l.block]].external.torque += f.torque;
    }
}

void Paces::pull(const Model& model, int parts, double dt, State& state) {
    Motion& motion = state.motion;
    for (Line& line : near_) {
        const BlockId b = line.block;
        // A block that is not pulled goes on along the same line, so that it does not matter whether it is near.
        if (!line.pulls() && !carried_[b]) continue;
        line.way += (parts - line.since) * motion.velocity[b];
        line.turn += (parts - line.since) * motion.spin[b];
        line.since = parts;
        line.position = motion.position[b];
        line.angle = motion.angle[b];
        const Force all{line.pull.force + line.external.force, line.pull.torque + line.external.torque};
        const Vec2 weight = carried_[b] ? line.weight : Vec2::Zero(), rest = line.external.force - weight;
        const Mean mean = mean_of_kick(model.blocks, b, all, motion, dt);
        BlockWork work;
        const Vec2& free = model.blocks.inv_mass[b];
        Axis{free.x(), mean.velocity.x(), dt}.add(all.force.x(), weight.x(), rest.x(), 0.0, work);
        Axis{free.y(), mean.velocity.y(), dt}.add(all.force.y(), weight.y(), rest.y(), 0.0, work);
        Axis{model.blocks.inv_inertia[b], mean.spin, dt}.add(all.torque, 0.0, line.external.torque, 0.0, work);
        add_kick(model.blocks, b, all, dt, motion);
        state.ledger.gravity += work.gravity;
        state.ledger.loads += work.loads;
        state.ledger.contact += work.all - work.gravity - work.loads;
        state.ledger.driven += work.driven;
    }
}

void Paces::take_pulls(std::span<Force> load) {
    for (Line& line : near_) {
        line.load = load[line.block];
        load[line.block].force -= line.pull.force + line.external.force;
        load[line.block].torque -= line.pull.torque + line.external.torque;
    }
}

void Paces::put_back(std::span<Force> load) const {
    for (const Line& line : near_) load[line.block] = line.load;
}

double kick_and_book(const Model& model, std::span<const BlockRange> ranges, const HalfKick& half, State& state) {
    const double loads = work_of_loads(model, half, state), dt = half.dt;
    const Vec2 g(model.gravity_x(half.time), model.gravity_y(half.time));
    const double share = state.release.empty() ? 0.0 : release_share(model, half.time);
    Motion& motion = state.motion;
    std::vector<BlockWork> work(ranges.size());
    for_all(static_cast<int>(ranges.size()), 1, [&](int k) {
        for (BlockId b = ranges[k].begin; b < ranges[k].end; ++b) {
            const Force load = half.load[b], damping = half.damping.empty() ? Force{} : half.damping[b];
            const bool external = !half.without_external(b);
            const Force release =
                share == 0.0 || !external ? Force{} : Force{share * state.release[b].force, share * state.release[b].torque};
            const Mean mean = mean_of_kick(model.blocks, b, load, motion, dt);
            const Vec2 &free = model.blocks.inv_mass[b], weight = external ? Vec2(model.blocks.mass[b] * g) : Vec2::Zero();
            Axis{free.x(), mean.velocity.x(), dt}.add(load.force.x(), weight.x(), release.force.x(), damping.force.x(),
                                                      work[k]);
            Axis{free.y(), mean.velocity.y(), dt}.add(load.force.y(), weight.y(), release.force.y(), damping.force.y(),
                                                      work[k]);
            Axis{model.blocks.inv_inertia[b], mean.spin, dt}.add(load.torque, 0.0, release.torque, damping.torque, work[k]);
            add_kick(model.blocks, b, load, dt, motion);
            const double speed = motion.velocity[b].norm() + std::abs(motion.spin[b]) * model.blocks.radius[b];
            work[k].speed = std::isfinite(speed) ? std::max(work[k].speed, speed) : std::numeric_limits<double>::infinity();
        }
    });
    BlockWork sum{.loads = loads};
    for (const BlockWork& w : work) {
        sum.all += w.all;
        sum.gravity += w.gravity;
        sum.loads += w.loads;
        sum.damping += w.damping;
        sum.driven += w.driven;
        sum.speed = std::max(sum.speed, w.speed);
    }
    Ledger& ledger = state.ledger;
    ledger.gravity += sum.gravity;
    ledger.loads += sum.loads;
    ledger.local_damping += sum.damping;
    ledger.driven += sum.driven;
    ledger.contact += sum.all - sum.gravity - sum.loads - sum.damping;
    return sum.speed;
}

}  // namespace talus
