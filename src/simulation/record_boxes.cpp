#include "simulation/record_boxes.hpp"

#include "core/errors.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace talus {

Trajectory record_boxes(const Scenario& scenario, const RecordBoxes& what, const Say& say) {
    if (what.steps < 1) throw InputError("steps: " + std::to_string(what.steps) + " is not 1 or more");
    if (what.every < 1) throw InputError("every: " + std::to_string(what.every) + " is not 1 or more");
    const Moment from(scenario, what.from);
    Scene scene = build(scenario);
    if (what.axes_deg) {
        const double angle = *what.axes_deg * std::numbers::pi / 180.0;
        scene.model.box_axis = {std::cos(angle), std::sin(angle)};
    }
    Simulation simulation(scenario, std::move(scene));
    Trajectory trajectory;
    trajectory.boxes = simulation.model().parts.size();
    check_trajectory_fits(std::to_string(trajectory.boxes) + " boxes x " + std::to_string(what.steps) + " steps",
                          static_cast<double>(trajectory.boxes), what.steps);
    advance_to(simulation, from, say);
    trajectory.dt = what.every * simulation.state().stage_step;
    trajectory.all.reserve(trajectory.boxes * what.steps);
    std::vector<Box> boxes;
    for (std::int64_t taken = 0;; ++taken) {
        if (taken % what.every == 0) {
            simulation.part_boxes(boxes);
            trajectory.all.insert(trajectory.all.end(), boxes.begin(), boxes.end());
            say("recording, step " + std::to_string(trajectory.steps()) + " of " + std::to_string(what.steps));
        }
        if (static_cast<int>(trajectory.steps()) == what.steps || !step_on(simulation)) return trajectory;
    }
}

}  // namespace talus
