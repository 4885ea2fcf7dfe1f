// The explicit method: kick-drift-kick with the springs and the strength of the joints.
#include "core/errors.hpp"
#include "dynamics/freeze.hpp"
#include "dynamics/motion.hpp"
#include "dynamics/substeps.hpp"
#include "dynamics/time_step.hpp"
#include "model/measure.hpp"
#include "simulation/deep_overlap.hpp"
#include "simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace talus {
namespace {

constexpr int energy_interval = 100;  // steps between looks at the energy: hardly costs, and an instability takes as many

}  // namespace

void Simulation::step_explicit(double dt) {
    state_.fast.empty() ? move(dt) : move_in_substeps(dt);
    if (!state_.calm.empty()) freeze_and_wake();
    check_speed();
    if (!scenario_.run.unchecked && time_to_look(state_.total_steps, speed_, dt, stable_.thinnest)) check_overlaps();
    state_.step_halvings = halvings_for(speed_);
    const double whole = std::ldexp(state_.stage_step, -state_.step_halvings) * (1.0 - 1e-6);
    // Not after a step that was cut: what leapfrog keeps is another sum for each length of step.
    if (dt >= whole && (state_.total_steps % energy_interval == 0 || time_step() < whole))
        check_energy_explicit(energy_explosion);
}

// What is driven or loaded may get its speed within the step that comes.
int Simulation::halvings_for(double speed) const {
    int halvings = step_halvings(state_.stage_step, state_.step_halvings, speed, narrowest_);
    if (model_.driven.empty() && static_cast<int>(model_.loads.size()) == model_.boundary_loads) return halvings;
    const auto dt = [&] { return std::ldexp(state_.stage_step, -halvings); };
    const auto ahead = [&] { return std::max(speed, speed_ahead(model_, state_.stage_time, dt())); };
    while (ahead() * dt() > 0.25 * narrowest_)
        if (++halvings > most_halvings)
            throw DivergenceError("a load or a driven block gives a speed of " + std::to_string(ahead()) +
                                  " m/s within a step");
    return halvings;
}

void Simulation::move(double dt) {
    keep_forces();
    kick(model_, awake_, load_before_, state_.motion, dt / 2);  // v(t) -> v(t + dt/2)
    drive(model_, state_.stage_time + dt / 2, state_.motion);
    drift(awake_, state_.motion, dt);  // x(t) -> x(t + dt)
    state_.time += dt;
    state_.stage_time += dt;
    lap(Part::move);
    update_forces(dt);
    speed_ =
        account(model_, awake_, {load_before_, damping_before_}, {state_.load, state_.damping}, state_, dt, state_.ledger);
    lap(Part::account);
    kick(model_, awake_, state_.load, state_.motion, dt / 2);  // v(t + dt/2) -> v(t + dt)
    drive(model_, state_.stage_time, state_.motion);
}

// Blocks that pass through each other because the step is too long have gained energy first: then that is the cause to tell.
void Simulation::check_overlaps() {
    // What is frozen does not come closer: it is looked at as rarely as can be.
    const std::string trouble = state_.calm.empty() || rare_look(state_.total_steps)
                                    ? no_room_left(model_, placed_, state_)
                                    : no_room_left(model_, placed_, state_, awake_, contact_index_);
    if (trouble.empty()) return;
    check_energy_explicit(energy_alarm);
    throw DivergenceError(trouble);
}

// Those of the step that begins, as they were at its start.
void Simulation::keep_forces() {
    load_before_.resize(state_.load.size());
    damping_before_.resize(state_.damping.size());
    if (state_.calm.empty()) {  // what is swapped into the state is overwritten, all of it
        load_before_.swap(state_.load);
        damping_before_.swap(state_.damping);
        return;
    }
    for (const BlockRange& range : awake_.moving) {
        std::copy(&state_.load[range.begin], &state_.load[range.begin] + (range.end - range.begin),
                  &load_before_[range.begin]);
        if (!state_.damping.empty())
            std::copy(&state_.damping[range.begin], &state_.damping[range.begin] + (range.end - range.begin),
                      &damping_before_[range.begin]);
    }
}

void Simulation::update_forces(double dt) {  // dt = 0 once at the start: no slip
    const bool left = place(model_, awake_, state_.motion, skin_, placed_);
    lap(Part::place);
    if (left) renew_list();
    lap(Part::search);
    update_contacts(model_, placed_, dt, Pace::all, state_, contact_index_);
    lap(Part::contacts);
    sum_forces();
}

void Simulation::renew_list() {
    refresh(skin_);
    if (!state_.calm.empty()) find_awake(true);
}

void Simulation::sum_forces() {
    weigh(model_, awake_.loaded, state_, state_.load);
    add_loads(model_, state_, Pace::all, state_.load);
    sum_contacts(awake_.loaded, state_.contacts, contact_index_, state_.load);
    if (model_.local_damping > 0.0) damp_locally(model_, awake_, state_.motion, state_.load, state_.damping);
    lap(Part::sum);
}

void Simulation::find_awake(bool list_renewed) {
    const int nb = model_.blocks.size();
    resting_gravity_.setConstant(std::numeric_limits<double>::quiet_NaN());
    was_frozen_.resize(nb);
    std::vector<BlockId> changed;
    for (BlockId b = 0; b < nb; ++b) {
        if (was_frozen_[b] == state_.frozen(b)) continue;
        was_frozen_[b] = state_.frozen(b);
        changed.push_back(b);
        sort_contacts_again(model_, state_.contacts, b, contact_index_);
        if (state_.frozen(b))
            placed_.block[b] = {state_.motion.position[b], state_.motion.velocity[b], state_.motion.spin[b],
                                state_.motion.angle[b]};
    }
    if (state_.calm.empty()) {
        awake_ = all_awake(nb);
        rest_.clear();
        return;
    }
    if (rest_.empty() || list_renewed) {
        rest_.resize(nb);
        changed.resize(nb);
        std::iota(changed.begin(), changed.end(), 0);
    }
    find_rest(model_, state_, contact_index_, changed, rest_);
    awake_ = awake(rest_);
}

double Simulation::frozen_share() const {
    const double all = static_cast<double>(freezing_steps_) * model_.blocks.size();
    return all == 0.0 ? 0.0 : 1.0 - static_cast<double>(moved_) / all;
}

void Simulation::freeze_and_wake() {
    ++freezing_steps_;
    for (const BlockRange& range : awake_.moving) moved_ += range.end - range.begin;
    // A stage that ends in equilibrium ends none the later for blocks that are frozen before.
    const double share = std::min(*scenario_.run.freeze, 0.25 * stage().until.equilibrium.value_or(1.0));
    const Vec2 gravity(model_.gravity_x(state_.stage_time), model_.gravity_y(state_.stage_time));
    const Calm calm{share, std::hypot(gravity.x(), gravity.y()),
                    [this](BlockId b) { return handed_on(state_.contacts, contact_index_, b); }};
    const bool look = state_.total_steps % freeze_interval == 0;
    bool changed = wake_disturbed(model_, awake_.loaded, calm, state_);
    // Of the others only the weight may have changed, or they would be among the loaded.
    if (look && (gravity != resting_gravity_ || !state_.release.empty())) {
        resting_gravity_ = gravity;
        weigh(model_, awake_.resting, state_, state_.load);
        sum_contacts(awake_.resting, state_.contacts, contact_index_, state_.load);
        changed |= wake_disturbed(model_, awake_.resting, calm, state_);
    }
    if (look) {
        const double before = ledger_error();
        const bool frozen = freeze_calm(model_, awake_, calm, state_);
        if (frozen) state_.ledger.local_damping += ledger_error() - before;  // the motion that was left is damped away
        changed |= frozen;
    }
    if (!changed) return;
    find_awake();
    paces_.forget();
}

// K - (dt^2/8) F M^-1 F + stored + dissipated - work is what kick-drift-kick keeps exactly while contacts are linear
// springs. The sum of energies itself swings by the term with F, by more than the energy there is when the step is near its
// limit. Dashpots count with half of what is booked: in the step in which a contact begins, their force acts at its end
// only.
void Simulation::check_energy_explicit(double most) {
    const Energies e = energies();
    const double dt = std::ldexp(state_.stage_step, -state_.step_halvings);
    const double swing = e.kinetic - kinetic_energy_of_ledger(model_, state_, dt);
    check_energy(e, e.total() - state_.ledger.total0 - swing - 0.5 * e.contact_damping, most);
}

void Simulation::begin_explicit() {
    if (scenario_.run.freeze) {
        wake_all(model_, state_);
        find_awake();
    }
    stable_ = stable_step(model_, placed_, state_);
    const StageSpec& now = stage();
    double dt = now.time_step.value_or(scenario_.run.step_fraction * stable_.bound);
    if (!std::isfinite(dt)) dt = now.until.time.value_or(1.0) / 1000;  // nothing that could move is stiff
    if (scenario_.run.substeps != 1) begin_substeps(dt);
    // A whole number of steps, so that none has to be cut at the end.
    if (now.until.time && !now.time_step) dt = *now.until.time / std::ceil(*now.until.time / dt);
    state_.stage_step = dt;
    narrowest_ = narrowest(model_, state_);
    sharp_turns_ = sharp_turns(model_, dt);
    state_.step_halvings = halvings_for(talus::max_speed(model_, state_));
}

}  // namespace talus
