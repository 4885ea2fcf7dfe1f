// What a verdict needs to know of the loads and of the solver.
#include "simulation/simulation.hpp"
#include "verdict/conclude.hpp"
#include "verdict/course.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace {

// Of free fall within a step, the speed to which the rigid solver finds velocities, and a margin of ten.
constexpr double rigid_speed = 1e-5;

// s, from which on the table has its last value: points that repeat it change nothing.
double last_change(const TimeTable& table) {
    std::size_t i = table.value.size();
    while (i > 0 && table.value[i - 1] == table.value.back()) --i;
    return i == 0 ? 0.0 : table.time[i];
}

double end_of_drive(const TimeTable& velocity) {  // s
    if (velocity.value.empty() || velocity.value.back() == 0.0) return last_change(velocity);
    return std::numeric_limits<double>::infinity();
}

}  // namespace

/// Whether gravity, loads and driven blocks have come to what they stay at. Before the last stage they have not.
bool Simulation::loads_are_on() const {
    if (state_.stage + 1 < stage_count()) return false;
    double end = std::max({last_change(model_.gravity_x), last_change(model_.gravity_y), model_.release_time});
    for (const Load& l : model_.loads)
        end = std::max({end, last_change(l.force_x), last_change(l.force_y), last_change(l.moment)});
    for (const DrivenBlock& d : model_.driven)
        end = std::max({end, end_of_drive(d.velocity_x), end_of_drive(d.velocity_y), end_of_drive(d.spin)});
    return state_.stage_time >= end * (1.0 - 1e-12);
}

Circumstances Simulation::circumstances() const {
    const double gravity = std::hypot(model_.gravity_x(state_.stage_time), model_.gravity_y(state_.stage_time));
    return {loads_are_on(), method().springs, method().springs ? 0.0 : rigid_speed * gravity * state_.stage_step,
            scenario_.run.smallest_failure};
}

void Simulation::look_at_blocks() {
    if (take_look(model_, footing_, state_)) close_window(model_, circumstances(), footing_, state_);
}

bool Simulation::ended_by_verdict() const { return stage().until.verdict && state_.course.verdict != Stability::undecided; }

StabilityVerdict Simulation::verdict() const {
    return timeless() ? conclude_static(model_, state_, circumstances()) : conclude(model_, state_, circumstances());
}

}  // namespace talus
