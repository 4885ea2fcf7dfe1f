// The explicit method: kick-drift-kick with the springs and the strength of the joints.
#include "core/errors.hpp"
#include "dynamics/motion.hpp"
#include "simulation/deep_overlap.hpp"
#include "simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace talus {
namespace {

constexpr int energy_interval = 100;  // steps between looks at the energy: hardly costs, and an instability takes as many

}  // namespace

void Simulation::step_explicit(double dt) {
    load_before_.resize(state_.load.size());  // what is swapped into the state is overwritten, all of it
    damping_before_.resize(state_.damping.size());
    load_before_.swap(state_.load);
    damping_before_.swap(state_.damping);
    kick(model_, load_before_, state_.motion, dt / 2);  // v(t) -> v(t + dt/2)
    drive(model_, state_.stage_time + dt / 2, state_.motion);
    drift(state_.motion, dt);  // x(t) -> x(t + dt)
    state_.time += dt;
    state_.stage_time += dt;
    lap(Part::move);
    update_forces(dt);
    speed_ = account(model_, {load_before_, damping_before_}, {state_.load, state_.damping}, state_, dt, state_.ledger);
    lap(Part::account);
    kick(model_, state_.load, state_.motion, dt / 2);  // v(t + dt/2) -> v(t + dt)
    drive(model_, state_.stage_time, state_.motion);
    check_speed();
    if (!scenario_.run.unchecked && time_to_look(state_.total_steps, speed_, dt, stable_.thinnest)) check_overlaps();
    state_.step_halvings = step_halvings(state_.stage_step, state_.step_halvings, speed_, stable_.thinnest);
    const double whole = std::ldexp(state_.stage_step, -state_.step_halvings) * (1.0 - 1e-6);
    // Not after a step that was cut: what leapfrog keeps is another sum for each length of step.
    if (dt >= whole && (state_.total_steps % energy_interval == 0 || time_step() < whole))
        check_energy_explicit(energy_explosion);
}

// Blocks that pass through each other because the step is too long have gained energy first: then that is the cause to tell.
void Simulation::check_overlaps() {
    const std::string trouble = no_room_left(model_, placed_, state_);
    if (trouble.empty()) return;
    check_energy_explicit(energy_alarm);
    throw DivergenceError(trouble);
}

void Simulation::update_forces(double dt) {  // dt = 0 once at the start: no slip
    const bool left = place(model_, state_.motion, skin_, placed_);
    lap(Part::place);
    if (left) refresh(skin_);
    lap(Part::search);
    update_contacts(model_, placed_, dt, state_, contact_index_);
    lap(Part::contacts);
    external_forces(model_, state_, state_.load);
    sum_contacts(model_, state_.contacts, contact_index_, state_.load);
    if (model_.local_damping > 0.0) damp_locally(model_, state_.motion, state_.load, state_.damping);
    lap(Part::sum);
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
    stable_ = stable_step(model_, placed_, state_);
    const StageSpec& now = stage();
    if (now.time_step) {
        state_.stage_step = *now.time_step;
    } else {
        double dt = scenario_.run.step_fraction * stable_.bound;
        // A whole number of steps, so that none has to be cut at the end.
        if (!std::isfinite(dt)) dt = now.until.time.value_or(1.0) / 1000;  // nothing that could move is stiff
        if (now.until.time) dt = *now.until.time / std::ceil(*now.until.time / dt);
        state_.stage_step = dt;
    }
}

}  // namespace talus
