// The rigid solver: blocks without any give, impulses instead of springs. Drift, kick, drift: contacts are where the blocks
// are in the middle of the step, so constant acceleration, sliding and rocking are second order in the step.
#include "core/errors.hpp"
#include "dynamics/motion.hpp"
#include "model/burden.hpp"
#include "rigid/scratch.hpp"
#include "simulation/deep_overlap.hpp"
#include "simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace {

// Change of any relative velocity in the last sweep over that of free fall within a step: forces are then known to about as
// much of a block's weight, and in a stack of 100 to a hundred times it. Ten times more, and a stack of 40 leans by
// millimetres in a minute; ten times less costs a third more sweeps.
constexpr double tolerance = 1e-6;
constexpr int sweeps = 200;         // of a step: what is not there by then is taken up by the next
constexpr int first_sweeps = 5000;  // when nothing is known of the forces yet

// Of the time in which a block falls freely through its own size. The error of a rocking or rolling block is then 1e-5 of
// its swing; half of it makes a quarter of the error.
constexpr double share_of_fall = 1.0 / 80.0;

// Of the way of free fall in a step: gaps and overlaps below are left alone. 1e-8 m for blocks of 1 m; half or twice of it
// changes the cost of a resting mass and nothing that can be seen.
constexpr double settled = 1e-4;

// Contacts are looked for ahead of the motion, so nothing can pass through a part in less than the way of its whole width;
// of that, twice as much may be used as by the explicit solver, which looks back.
constexpr double wider = 2.0;

// Of free fall within a step: where sweeps end before relative velocities are known to this, the step is counted and the run
// warns. A tenth of it would count steps in which a tall stack is still a hundredth of its weight off where it matters to
// nobody; ten times more is creep that can be seen within a second.
constexpr double unsolved = 1e-3;

// Two bounces of one block within a step: what the first does to the second is not known before. Steps are cut where the
// second has more than this share of the energy of all that moves; a tenth of it would cut every step of a heap of a
// thousand blocks that clatters, for what nobody sees. The next step begins whole again, so that a row of impacts costs so
// many steps as there are impacts, each tried as often as it is halved.
constexpr double worth_a_cut = 1e-3;
constexpr int most_cuts = 16;  // halvings: what follows faster, such as both corners of an edge, lands together

constexpr int most_looks = 8;  // for touches, with the speeds after the impacts of the look before; a step has one or two

constexpr int energy_interval = 100;
constexpr int most_breaks = 50;  // rounds of breaking bonds within a step

using rigid::Bodies;
using rigid::Velocity;

Vec2 at(const Velocity& v, const Vec2& arm) { return Vec2(v.x, v.y) + v.spin * perp(arm); }

void move_bodies(Bodies& bodies, std::span<const Velocity> v, double dt) {
    for (int q = 0; q < bodies.size(); ++q) bodies.position[q] += dt * Vec2(v[q].x, v[q].y);
}

}  // namespace

void Simulation::begin_rigid() {
    stable_ = stable_step(model_, placed_, state_);
    const StageSpec& now = stage();
    if (now.time_step) {
        state_.stage_step = *now.time_step;
        return;
    }
    double dt = step_of_fall(model_, std::span<const Load>(model_.loads).subspan(model_.boundary_loads), share_of_fall);
    if (now.until.time) dt = *now.until.time / std::ceil(*now.until.time / dt);
    state_.stage_step = dt;
}

void Simulation::forces_rigid(double) {
    rigid_ = std::make_unique<rigid::Scratch>();  // a new stage: other blocks, joints or boxes
    rigid_->bodies = rigid::join_bonded(model_, state_);
    placed_.boxed.clear();
    renew_pairs_rigid(0.0);
}

/// Every pair closer than `reach` (m) is in the list then.
void Simulation::renew_pairs_rigid(double reach) {
    rigid::Scratch& r = *rigid_;
    if (r.skin < std::max(skin_, 2.0 * reach)) {
        r.skin = std::max(skin_, 4.0 * reach);
        placed_.boxed.clear();
    }
    const bool left = place(model_, awake_, state_.motion, r.skin - reach, placed_);
    lap(Part::place);
    if (left) refresh(r.skin);
    r.renewed |= left;
    lap(Part::search);
}

void Simulation::step_rigid(double dt) {
    if (!rigid_) rigid_ = std::make_unique<rigid::Scratch>();
    rigid::Scratch& r = *rigid_;
    r.start = state_.motion;
    bool unfinished = false;  // bonds broke in the last round that there is
    for (int round = 0;; ++round) {
        if (!r.bodies) {
            r.bodies = rigid::join_bonded(model_, state_);
            r.bonds.reset();
            r.renewed = true;
        }
        while (!half_step_rigid(dt)) {
            state_.motion = r.start;
            dt = time_step();
        }
        const bool broke = break_bonds_rigid(dt);
        unfinished = broke && round == most_breaks;
        if (!broke || unfinished) break;
        state_.motion = r.start;
        r.bodies.reset();
    }
    if (!scenario_.run.unchecked) check_overlaps_rigid();
    finish_step_rigid(dt);
    if (unfinished) r.bodies.reset();
    lap(Part::account);
    check_speed();
    const double width = std::min(wider * stable_.thinnest, 4.0 * scenario_.run.most_travel.value_or(stable_.thinnest));
    state_.step_halvings = step_halvings(state_.stage_step, state_.step_halvings, speed_, width);
    if (state_.total_steps % energy_interval == 0) {
        const Energies e = energies();
        check_energy(e, e.total() - state_.ledger.total0, energy_explosion);
    }
}

/// From the middle of the step, where the impulses are known, to its end.
void Simulation::finish_step_rigid(double dt) {
    rigid::Scratch& r = *rigid_;
    Bodies& bodies = *r.bodies;
    const double fall = fall_rigid();
    r.middle = state_.motion.position;
    drift(bodies, dt / 2, state_.motion, bodies.velocity);
    move_bodies(bodies, bodies.velocity, dt / 2);
    if (r.touches.correct(bodies, r.before, bodies.velocity, std::max(settled * fall * dt * dt, 1e-12), dt,
                          r.displacement)) {
        drift(bodies, 1.0, state_.motion, r.displacement);
        move_bodies(bodies, r.displacement, 1.0);
    }
    r.touches.record(model_, placed_, bodies, r.before, bodies.velocity, r.displacement, dt, 10.0 * rigid_resolution(dt),
                     state_);
    lap(Part::contacts);
    state_.time += dt;
    state_.stage_time += dt;
    account_rigid(r.start, r.middle, dt);
    scatter(bodies, state_.motion);
    drive(model_, state_.stage_time, state_.motion);
    if (r.left <= unsolved * std::max(fall * dt, 1e-3 * r.fastest)) return;
    ++state_.unsolved.steps;
    state_.unsolved.speed = std::max(state_.unsolved.speed, r.left);
    state_.unsolved.way += r.left * dt;
}

// Nothing comes so far into anything within half a step: who lies deeper has been pressed there, and would come out on the
// other side.
void Simulation::check_overlaps_rigid() const {
    const auto& [slot, depth, share] = rigid_->touches.deepest();
    if (slot < 0) return;
    const std::string trouble = no_room_left(model_, placed_, state_, state_.contacts.list[slot], depth);
    if (!trouble.empty()) throw DivergenceError(trouble);
}

/// Whether nothing at `speed` (m/s) moves further than it may within a step; if not, steps are shorter from now on.
bool Simulation::short_enough_rigid(double speed) {
    const int needed = step_halvings(state_.stage_step, state_.step_halvings, speed, wider * stable_.thinnest);
    if (needed <= state_.step_halvings) return true;
    state_.step_halvings = needed;
    return false;
}

/// m/s, to which relative velocities are found.
double Simulation::rigid_resolution(double dt) const {
    return tolerance * std::max(fall_rigid() * dt, 1e-4 * rigid_->fastest);
}

/// m/s2, largest acceleration by weight and loads.
double Simulation::fall_rigid() const {
    double fall = 0.0;
    for (BlockId b = 0; b < model_.blocks.size(); ++b) {
        const Vec2 a = rigid_->external[b].force.cwiseProduct(model_.blocks.inv_mass[b]);
        fall = std::max(fall, std::abs(a.x()) + std::abs(a.y()));
    }
    return fall;
}

/// To the middle of the step, and the velocities after it; false if a block would move too far in it: steps are shorter
/// then.
bool Simulation::half_step_rigid(double dt) {
    rigid::Scratch& r = *rigid_;
    Bodies& bodies = *r.bodies;
    gather(model_, state_.motion, bodies);
    r.before = bodies.velocity;
    if (!short_enough_rigid(rigid::Touches::fastest(model_, state_.motion, bodies))) return false;
    drift(bodies, dt / 2, state_.motion, r.before);
    move_bodies(bodies, r.before, dt / 2);
    r.external.resize(model_.blocks.size());
    weigh_over(model_, state_, dt, r.external);
    drive(model_, state_.stage_time + dt, state_.motion);

    for (BlockId b = 0; b < model_.blocks.size(); ++b) {
        const int q = bodies.body_of[b];
        const rigid::Softness& soft = bodies.softness[q];
        const Force& f = r.external[b];
        Velocity& v = bodies.velocity[q];
        v.x += dt * soft.x * f.force.x();
        v.y += dt * soft.y * f.force.y();
        v.spin += dt * soft.spin * (f.torque + cross(state_.motion.position[b] - bodies.position[q], f.force));
    }
    for (const DrivenBlock& d : model_.driven) {
        const int q = bodies.body_of[d.block];
        const Velocity prescribed = rigid::seen_from(state_.motion, d.block, bodies.position[q]);
        Velocity& v = bodies.velocity[q];
        if (!bodies.single(q)) v = prescribed;
        if (d.x) v.x = prescribed.x;
        if (d.y) v.y = prescribed.y;
        if (d.rotation) v.spin = prescribed.spin;
    }
    lap(Part::move);

    r.fastest = rigid::Touches::fastest(model_, state_.motion, bodies);
    if (!short_enough_rigid(r.fastest)) return false;
    const bool rebounds = std::ranges::any_of(model_.joints, [](const Joint& j) { return j.restitution > 0.0; });
    r.kicked = bodies.velocity;
    r.touches.forget_speeds();
    for (int look = 1;; ++look) {
        find_and_solve_rigid(rebounds, dt);
        if (!short_enough_rigid(rigid::Touches::fastest(model_, state_.motion, bodies)) || !one_by_one_rigid(dt))
            return false;
        // Whom an impact has set in motion may come to others in this very step.
        if (!rebounds || look == most_looks || !r.touches.outrun(model_, placed_, bodies)) break;
        bodies.velocity = r.kicked;
    }
    r.touches.add_earlier(10.0 * rigid_resolution(dt));
    lap(Part::sum);
    return true;
}

/// Impulses of all that may touch in this step, and the velocities after it.
void Simulation::find_and_solve_rigid(bool rebounds, double dt) {
    rigid::Scratch& r = *rigid_;
    Bodies& bodies = *r.bodies;
    const double fastest = rebounds ? rigid::Touches::fastest(model_, state_.motion, bodies, rebounds) : r.fastest;
    renew_pairs_rigid(dt * std::max(fastest, r.touches.fastest_seen()));
    if (r.renewed) {
        r.touches.forget_hints();
        if (r.bonds)
            r.bonds->find_slots(state_);
        else
            r.bonds.emplace(model_, state_, bodies);
        r.renewed = false;
    }
    r.touches.find(model_, placed_, state_, bodies, r.before, rebounds, 0.5 * fall_rigid() * dt * dt, dt);
    for (const rigid::Touch& c : r.touches.list()) {
        apply(c, c.p, bodies.softness, bodies.velocity);
        apply(c, c.earlier, bodies.softness, bodies.velocity);
    }
    const bool unknown = state_.stage_time == 0.0;
    r.left = r.solver
                 .solve(r.touches.list(), bodies.softness, bodies.velocity,
                        {rigid_resolution(dt), unknown ? first_sweeps : sweeps})
                 .left;
}

/// Whether each bounce of a block has a step of its own, as far as it matters; if not, steps are cut. What is left lands
/// together.
bool Simulation::one_by_one_rigid(double dt) {
    rigid::Scratch& r = *rigid_;
    Bodies& bodies = *r.bodies;
    const double slow = 2.0 * fall_rigid() * state_.stage_step;
    const double together = std::ldexp(1.0, std::min(state_.step_halvings - most_cuts, 0));
    const double later = r.touches.energy_of_later_landings(bodies, r.before, slow, together, dt);
    if (later == 0.0) return true;
    if (state_.step_halvings < most_cuts && worth_a_cut_rigid(later)) {
        ++state_.step_halvings;
        return false;
    }
    while (r.touches.land_together(bodies, r.before, slow, dt))
        r.left = r.solver.solve(r.touches.list(), bodies.softness, bodies.velocity, {rigid_resolution(dt), sweeps}).left;
    return true;
}

/// Of the energy of later landings (J).
bool Simulation::worth_a_cut_rigid(double later) const {
    const Bodies& bodies = *rigid_->bodies;
    double kinetic = 0.0;
    for (BlockId b = 0; b < model_.blocks.size(); ++b) {
        if (model_.blocks.held(b)) continue;
        const int q = bodies.body_of[b];
        const Velocity& v = rigid_->before[q];
        kinetic += 0.5 * (model_.blocks.mass[b] * at(v, state_.motion.position[b] - bodies.position[q]).squaredNorm() +
                          model_.blocks.inertia[b] * v.spin * v.spin);
    }
    return later > worth_a_cut * kinetic;
}

/// True if some bond broke: the step has to be done again without it.
bool Simulation::break_bonds_rigid(double dt) {
    rigid::Scratch& r = *rigid_;
    const Bodies& bodies = *r.bodies;
    const int nb = model_.blocks.size();
    r.contact.assign(nb, {});
    r.touches.add_forces(model_, placed_, state_, dt, r.contact);
    r.unbalanced.resize(nb);
    for (BlockId b = 0; b < nb; ++b) {
        const int q = bodies.body_of[b];
        const Vec2 arm = state_.motion.position[b] - bodies.position[q];
        const Velocity &v0 = r.before[q], &v1 = bodies.velocity[q];
        const double spin = 0.5 * (v0.spin + v1.spin);
        const Vec2 gained = model_.blocks.mass[b] / dt * (at(v1, arm) - at(v0, arm));
        const double turned = model_.blocks.inertia[b] / dt * (v1.spin - v0.spin);
        Force& f = r.unbalanced[b];
        f.force = r.contact[b].force + r.external[b].force - gained + model_.blocks.mass[b] * spin * spin * arm;
        f.torque = r.contact[b].torque + r.external[b].torque - turned;
        state_.load[b] = {gained, turned};
    }
    return !r.bonds->none() && r.bonds->carry(model_, r.unbalanced, state_) > 0;
}

/// Work of weight, loads and driven blocks over the way that was really gone.
void Simulation::account_rigid(const Motion& start, std::span<const Vec2> middle, double dt) {
    rigid::Scratch& r = *rigid_;
    Ledger& ledger = state_.ledger;
    const Vec2 g = mean_gravity(model_, state_.stage_time - dt, dt);
    speed_ = 0.0;
    double fall =
        0.0;  // J, that all blocks would gain in this step by weight and loads: what nothing at rest is judged against
    for (BlockId b = 0; b < model_.blocks.size(); ++b) {
        const int q = r.bodies->body_of[b];
        const Velocity& v = r.bodies->velocity[q];
        const Vec2 moved = state_.motion.position[b] - start.position[b];
        const double turned = state_.motion.angle[b] - start.angle[b];
        const Vec2 arm = middle[b] - r.bodies->position[q];
        const double speed = at(v, arm).norm() + std::abs(v.spin) * model_.blocks.radius[b];
        speed_ = std::isfinite(speed) ? std::max(speed_, speed) : std::numeric_limits<double>::infinity();
        const Velocity uneven = r.touches.uneven_way(*r.bodies, r.before, q, dt);
        ledger.contact_damping += r.external[b].force.dot(at(uneven, arm)) + r.external[b].torque * uneven.spin;
        const Vec2& free = model_.blocks.inv_mass[b];
        const Vec2 weight = model_.blocks.mass[b] * g;
        const Vec2 load = r.external[b].force - weight;
        fall += 0.5 * r.external[b].force.squaredNorm() / model_.blocks.mass[b] * dt * dt;
        for (const int axis : {0, 1}) {
            if (free[axis] != 0.0)
                ledger.gravity += weight[axis] * moved[axis], ledger.loads += load[axis] * moved[axis];
            else
                ledger.driven -= r.contact[b].force[axis] * moved[axis];
        }
        if (r.bodies->driver[q] >= 0 && !model_.blocks.held(b))  // what takes it along
            ledger.driven -= r.unbalanced[b].force.dot(moved) + r.unbalanced[b].torque * turned;
        if (model_.blocks.inv_inertia[b] != 0.0)
            ledger.loads += r.external[b].torque * turned;
        else
            ledger.driven -= r.contact[b].torque * turned;
    }
    ledger.contact = -ledger.friction - ledger.contact_damping - ledger.driven;
    ledger.largest = std::max(ledger.largest, fall);
}

}  // namespace talus
