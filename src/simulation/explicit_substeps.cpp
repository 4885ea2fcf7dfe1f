// A step of the explicit solver in which small blocks take several, see dynamics/substeps.hpp.
#include "dynamics/motion.hpp"
#include "simulation/simulation.hpp"

#include <algorithm>
#include <utility>

namespace talus {

void Simulation::begin_substeps(double& dt) {
    if (stage().until.equilibrium) return;  // forces at the ends of steps would stay out of balance
    const std::vector<double> limits = block_limits(model_, placed_, state_);
    const double fraction = scenario_.run.step_fraction, share = std::min(slow_share, fraction);
    const int most = scenario_.run.substeps;  // 0: what saves most
    Substeps found;
    if (most == 0 && !stage().time_step) {
        ChosenSubsteps chosen = choose_substeps(model_, state_, limits, dt, share);
        found = std::move(chosen.substeps);
        dt = chosen.step;
    } else if (stage().time_step) {
        found = substeps_of_step(model_, state_, limits, most, dt, fraction);
    } else {  // as many as leave any block slow
        for (int count = most; count > 1 && found.count == 1; count /= 2)
            found = substeps_for(model_, state_, limits, count, count * dt, share);
        dt *= found.count;
    }
    if (found.count == 1) return;
    state_.substeps = found.count;
    state_.fast = std::move(found.fast);
    placed_.boxed.clear();  // the list gets chunks for each pace
    paces_.forget();
}

double Simulation::gain_of_substeps() const {
    const double fraction = scenario_.run.step_fraction;
    return choose_substeps(model_, state_, block_limits(model_, placed_, state_), fraction * stable_.bound,
                           std::min(slow_share, fraction))
        .substeps.gain;
}

// The kicks of slow blocks stand outside, those that come of fast blocks inside.
void Simulation::move_in_substeps(double dt) {
    const int parts = state_.substeps;
    const double part = dt / parts, start = state_.stage_time;
    Motion& motion = state_.motion;
    if (placed_.boxed.empty()) {
        place(model_, awake_, motion, skin_, placed_);
        renew_list();
    }
    if (!paces_.known()) paces_.find(model_, state_);
    drive(model_, start + dt / 2, motion);
    paces_.begin_step(model_, state_);
    paces_.take_pulls(state_.load);
    speed_ =
        kick_and_book(model_, paces_.slow(), {state_.load, state_.damping, start, dt / 2, false, paces_.carried()}, state_);
    if (!paces_.others_stay(model_, motion, placed_, skin_, dt)) {
        paces_.all_become_near(model_, state_, 0);
        paces_.find_pulls(model_, state_);
    }
    const auto kick_fast = [&](int at) {
        const HalfKick half{state_.load, state_.damping, state_.stage_time, part / 2, true};
        speed_ = std::max(speed_, kick_and_book(model_, paces_.fast().moving, half, state_));
        paces_.pull(model_, at, part / 2, state_);
    };
    for (int i = 1; i <= parts; ++i) {
        kick_fast(i - 1);
        drift(paces_.fast(), motion, part);
        paces_.move_near(i, part, motion);
        state_.stage_time = i < parts ? start + i * part : start + dt;
        if (i < parts) {
            forces_in_substep(i, part);
        } else {
            paces_.move_others(dt, motion);
            forces_of_step(dt);
        }
        kick_fast(i);
    }
    state_.time += dt;
    kick_and_book(model_, paces_.slow(), {state_.load, state_.damping, state_.stage_time, dt / 2, false, paces_.carried()},
                  state_);
    paces_.put_back(state_.load);
    drive(model_, state_.stage_time, motion);
}

// Of fast blocks, and what their contacts do to near ones.
void Simulation::forces_in_substep(int parts, double part) {
    lap(Part::move);
    const bool left = place(model_, paces_.inner(), state_.motion, skin_, placed_);
    lap(Part::place);
    if (left) {
        paces_.all_become_near(model_, state_, 0);
        paces_.move_near(parts, part, state_.motion);
        place(model_, awake_, state_.motion, skin_, placed_);
        renew_list();
        paces_.find_pulls(model_, state_);
    }
    lap(Part::search);
    update_contacts(model_, placed_, part, Pace::fast, state_, contact_index_);
    lap(Part::contacts);
    weigh(model_, paces_.fast().moving, state_, state_.load);
    add_loads(model_, state_, Pace::fast, state_.load);
    sum_contacts(paces_.fast().moving, state_.contacts, contact_index_, state_.load);
    if (model_.local_damping > 0.0) damp_locally(model_, paces_.fast(), state_.motion, state_.load, state_.damping);
    paces_.sum_pulls(model_, state_);
    lap(Part::sum);
}

// Of all blocks at the end of a step; loads are then without what fast contacts do to near ones.
void Simulation::forces_of_step(double dt) {
    const int parts = state_.substeps;
    lap(Part::move);
    const bool left = place(model_, awake_, state_.motion, skin_, placed_);
    lap(Part::place);
    if (left) {
        paces_.all_become_near(model_, state_, parts);
        renew_list();
        paces_.find_pulls(model_, state_);
    }
    lap(Part::search);
    update_contacts(model_, placed_, dt / parts, Pace::fast, state_, contact_index_);
    paces_.place_means(state_.motion, parts, placed_);
    update_contacts(model_, placed_, dt, Pace::slow, state_, contact_index_);
    lap(Part::contacts);
    sum_forces();
    paces_.sum_pulls(model_, state_);
    paces_.take_pulls(state_.load);
}

}  // namespace talus
