#include "dynamics/motion.hpp"

#include "core/parallel.hpp"
#include "core/turn.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace talus {
namespace {

double sign(double v) { return v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0; }

struct BlockWork {  // of one range, J, and its largest speed, m/s
    double all = 0.0, gravity = 0.0, damping = 0.0, driven = 0.0, speed = 0.0;
};

// N2/kg: what the product form of the kinetic energy takes away, times dt^2/8. What is frozen does not swing.
double force_squared(const Model& model, const Awake& awake, std::span<const Force> load) {
    double sum = 0.0;
    for (const BlockRange& range : awake.moving)
        for (int b = range.begin; b < range.end; ++b) sum += force_squared(model.blocks, b, load[b]);
    return sum;
}

Force load_of(const Load& l, const Vec2& force, double moment, double angle) {
    return {force, cross(turned(l.arm, angle), force) + moment};
}

}  // namespace

Force load_at(const Load& l, double t, double angle) { return load_of(l, {l.force_x(t), l.force_y(t)}, l.moment(t), angle); }

void kick(const Model& model, const Awake& awake, std::span<const Force> load, Motion& motion, double dt) {
    for_all(static_cast<int>(awake.moving.size()), 1, [&](int k) {
        const BlockRange& range = awake.moving[k];
        for (int b = range.begin; b < range.end; ++b) {
            motion.velocity[b] += dt * load[b].force.cwiseProduct(model.blocks.inv_mass[b]);
            motion.spin[b] += dt * load[b].torque * model.blocks.inv_inertia[b];
        }
    });
}

void drift(const Awake& awake, Motion& motion, double dt) {
    for_all(static_cast<int>(awake.moving.size()), 1, [&](int k) {
        const BlockRange& range = awake.moving[k];
        for (int b = range.begin; b < range.end; ++b) {
            motion.position[b] += dt * motion.velocity[b];
            motion.angle[b] += dt * motion.spin[b];
        }
    });
}

void drive(const Model& model, double t, Motion& motion) {
    for (const DrivenBlock& d : model.driven) {
        if (d.x) motion.velocity[d.block].x() = d.velocity_x(t);
        if (d.y) motion.velocity[d.block].y() = d.velocity_y(t);
        if (d.rotation) motion.spin[d.block] = d.spin(t);
    }
}

bool place(const Model& model, const Awake& awake, const Motion& motion, double skin, Placed& placed) {
    const int nb = model.blocks.size();
    const bool all = placed.boxed.empty();
    const std::vector<BlockRange>& ranges = all ? all_awake(nb).moving : awake.moving;
    placed.corner.resize(model.corners.arm.size());
    const bool first = placed.block.empty();
    placed.block.resize(nb);
    placed.path.resize(nb);
    const Vec2 *arm = model.corners.arm.data(), *normal = model.corners.normal.data();
    const int *first_part = model.blocks.first_part.data(), *first_corner = model.parts.first_corner.data();
    PlacedCorner* corner = placed.corner.data();
    const Vec2 axis = model.box_axis;
    std::atomic<bool> left = all;
    constexpr int few = blocks_per_range / 4;  // their sines and cosines stay near
    for_all(static_cast<int>(ranges.size()), 1, [&](int k) {
        const BlockRange& range = ranges[k];
        for (int begin = range.begin; begin < range.end; begin += few) {
            const int n = std::min(few, range.end - begin);
            double c[few], s[few];
            for (int i = 0; i < n; ++i) {
                const Turn now = turn(motion.angle[begin + i]);
                c[i] = now.c;
                s[i] = now.s;
            }
            bool inside = true;
            for (int i = 0; i < n; ++i) {
                const int b = begin + i;
                const Vec2 position = motion.position[b];
                if (!first) placed.add_to_path(b, position, motion.angle[b], model.blocks.radius[b]);
                placed.block[b] = {position, motion.velocity[b], motion.spin[b], motion.angle[b]};
                if (!all) inside &= placed.boxed[b].moved(position, motion.angle[b], axis) <= skin;
                if (!all && model.blocks.inv_inertia[b] == 0.0 && motion.spin[b] == 0.0) continue;
                const double cosine = c[i], sine = s[i];
                for (int j = first_corner[first_part[b]]; j < first_corner[first_part[b + 1]]; ++j) {
                    const Vec2 p = arm[j], m = normal[j];
                    corner[j] = {{cosine * p.x() - sine * p.y(), sine * p.x() + cosine * p.y()},
                                 {cosine * m.x() - sine * m.y(), sine * m.x() + cosine * m.y()}};
                }
            }
            if (!inside) left.store(true, std::memory_order_relaxed);
        }
    });
    return left;
}

double release_share(const Model& model, double stage_time) {
    return stage_time < model.release_time ? 1.0 - stage_time / model.release_time : 0.0;
}

void weigh(const Model& model, std::span<const BlockRange> ranges, const State& state, std::span<Force> load) {
    const Vec2 g(model.gravity_x(state.stage_time), model.gravity_y(state.stage_time));
    const double share = state.release.empty() ? 0.0 : release_share(model, state.stage_time);
    for_all(static_cast<int>(ranges.size()), 1, [&](int k) {
        const BlockRange& range = ranges[k];
        for (int b = range.begin; b < range.end; ++b) {
            load[b] = {model.blocks.mass[b] * g, 0.0};
            if (share == 0.0) continue;
            load[b].force += share * state.release[b].force;
            load[b].torque += share * state.release[b].torque;
        }
    });
}

void add_loads(const Model& model, const State& state, Pace pace, std::span<Force> load) {
    for (const Load& l : model.loads) {
        if (!state.has(pace, l.block)) continue;
        const Force f = load_at(l, state.stage_time, state.motion.angle[l.block]);
        load[l.block].force += f.force;
        load[l.block].torque += f.torque;
    }
}

Vec2 mean_gravity(const Model& model, double stage_time, double dt) {
    const double middle = stage_time + 0.5 * dt;
    return {model.gravity_x.mean(middle, dt), model.gravity_y.mean(middle, dt)};
}

void weigh_over(const Model& model, const State& state, double dt, std::span<Force> load) {
    const int nb = model.blocks.size();
    const double middle = state.stage_time + 0.5 * dt;
    const Vec2 g = mean_gravity(model, state.stage_time, dt);
    const double share = state.release.empty() ? 0.0 : release_share(model, middle);
    for_all(nb, 1000, [&](int b) {
        load[b] = {model.blocks.mass[b] * g, 0.0};
        if (share == 0.0) return;
        load[b].force += share * state.release[b].force;
        load[b].torque += share * state.release[b].torque;
    });
    for (const Load& l : model.loads) {
        const Vec2 force(l.force_x.mean(middle, dt), l.force_y.mean(middle, dt));
        const Force f = load_of(l, force, l.moment.mean(middle, dt), state.motion.angle[l.block]);
        load[l.block].force += f.force;
        load[l.block].torque += f.torque;
    }
}

void damp_locally(const Model& model, const Awake& awake, const Motion& motion, std::span<Force> load,
                  std::vector<Force>& damping) {
    const double alpha = model.local_damping;
    damping.resize(model.blocks.size());
    for_all(static_cast<int>(awake.moving.size()), 1, [&](int k) {
        const BlockRange& range = awake.moving[k];
        for (int b = range.begin; b < range.end; ++b) {
            const Vec2& free = model.blocks.inv_mass[b];
            const Vec2 &f = load[b].force, &v = motion.velocity[b];
            damping[b].force = {free.x() == 0.0 ? 0.0 : -alpha * std::abs(f.x()) * sign(v.x()),
                                free.y() == 0.0 ? 0.0 : -alpha * std::abs(f.y()) * sign(v.y())};
            damping[b].torque =
                model.blocks.inv_inertia[b] == 0.0 ? 0.0 : -alpha * std::abs(load[b].torque) * sign(motion.spin[b]);
            load[b].force += damping[b].force;
            load[b].torque += damping[b].torque;
        }
    });
}

double account(const Model& model, const Awake& awake, const StepEnd& before, const StepEnd& after, const State& state,
               double dt, Ledger& ledger) {
    const int nb = model.blocks.size(), ranges = static_cast<int>(awake.moving.size());
    std::vector<BlockWork> work(ranges);
    const Motion& motion = state.motion;
    const double t0 = state.stage_time - dt, t1 = state.stage_time;
    const Vec2 g = 0.5 * Vec2(model.gravity_x(t0) + model.gravity_x(t1), model.gravity_y(t0) + model.gravity_y(t1));
    for_all(ranges, 1, [&](int k) {
        BlockWork& w = work[k];
        for (int b = awake.moving[k].begin; b < awake.moving[k].end; ++b) {
            const Vec2 &free = model.blocks.inv_mass[b], &v = motion.velocity[b];
            const double spin = motion.spin[b];
            const double speed = std::sqrt(v.squaredNorm()) + std::abs(spin) * model.blocks.radius[b];
            w.speed = std::isfinite(speed) ? std::max(w.speed, speed) : std::numeric_limits<double>::infinity();
            const double px = 0.5 * dt * v.x() * (before.load[b].force.x() + after.load[b].force.x());
            const double py = 0.5 * dt * v.y() * (before.load[b].force.y() + after.load[b].force.y());
            const double pr = 0.5 * dt * spin * (before.load[b].torque + after.load[b].torque);
            const double mass = dt * model.blocks.mass[b];
            if (free.x() != 0.0)
                w.all += px, w.gravity += mass * v.x() * g.x();
            else
                w.driven -= px - mass * v.x() * g.x();
            if (free.y() != 0.0)
                w.all += py, w.gravity += mass * v.y() * g.y();
            else
                w.driven -= py - mass * v.y() * g.y();
            if (model.blocks.inv_inertia[b] != 0.0)
                w.all += pr;
            else
                w.driven -= pr;
            if (!after.damping.empty())
                w.damping += 0.5 * dt * (v.dot(after.damping[b].force) + spin * after.damping[b].torque);
            if (!before.damping.empty())
                w.damping += 0.5 * dt * (v.dot(before.damping[b].force) + spin * before.damping[b].torque);
        }
    });
    double loads = 0.0;
    const auto add = [&](BlockId b, const Force& f) {
        if (model.blocks.inv_mass[b].x() != 0.0) loads += 0.5 * dt * motion.velocity[b].x() * f.force.x();
        if (model.blocks.inv_mass[b].y() != 0.0) loads += 0.5 * dt * motion.velocity[b].y() * f.force.y();
        if (model.blocks.inv_inertia[b] != 0.0) loads += 0.5 * dt * motion.spin[b] * f.torque;
    };
    for (const Load& l : model.loads) {
        add(l.block, load_at(l, t0, motion.angle[l.block] - dt * motion.spin[l.block]));
        add(l.block, load_at(l, t1, motion.angle[l.block]));
    }
    const double share = state.release.empty() ? 0.0 : release_share(model, t0) + release_share(model, t1);
    if (share != 0.0)
        for (int b = 0; b < nb; ++b) add(b, {share * state.release[b].force, share * state.release[b].torque});

    BlockWork sum;
    for (const BlockWork& w : work) {
        sum.all += w.all;
        sum.gravity += w.gravity;
        sum.damping += w.damping;
        sum.driven += w.driven;
        sum.speed = std::max(sum.speed, w.speed);
    }
    ledger.gravity += sum.gravity;
    ledger.loads += loads;
    ledger.local_damping += sum.damping;
    ledger.driven += sum.driven;
    ledger.contact += sum.all - sum.gravity - loads - sum.damping;
    // A halved step, or one cut at the end of its stage, belongs to another product form than that of the stage.
    if (dt != state.stage_step)
        ledger.kinetic0 += 0.125 * (state.stage_step * state.stage_step - dt * dt) *
                           (force_squared(model, awake, before.load) - force_squared(model, awake, after.load));
    return sum.speed;
}

double kinetic_energy_of_ledger(const Model& model, const State& state, double dt) {
    double energy = 0.0;
    const auto add = [&](double inverse, double v, double f, double own) {
        if (inverse != 0.0) energy += 0.5 * v * v / inverse - 0.125 * own * own * f * f * inverse;
    };
    for (int b = 0; b < model.blocks.size(); ++b) {
        if (state.frozen(b)) continue;  // does not swing
        const double own = state.is_fast(b) ? dt / state.substeps : dt;
        add(model.blocks.inv_mass[b].x(), state.motion.velocity[b].x(), state.load[b].force.x(), own);
        add(model.blocks.inv_mass[b].y(), state.motion.velocity[b].y(), state.load[b].force.y(), own);
        add(model.blocks.inv_inertia[b], state.motion.spin[b], state.load[b].torque, own);
    }
    return energy;
}

double ledger_error(const Model& model, const State& state, double dt) {
    const Ledger& l = state.ledger;
    return kinetic_energy_of_ledger(model, state, dt) - l.kinetic0 - l.gravity - l.loads - l.contact - l.local_damping;
}

}  // namespace talus
