// The boxes of a run as a trajectory.
#pragma once

#include "output/trajectory.hpp"
#include "scenario/scenario.hpp"
#include "simulation/advance.hpp"

#include <optional>
#include <string>

namespace talus {

struct RecordBoxes {
    int steps = 200;                      // in the trajectory
    int every = 1;                        // time steps of the run from one to the next
    std::string from;                     // the Moment at which it begins
    std::optional<double> axes_deg = {};  // of the boxes, from x and y; absent: as in a run, see box_axis()
};

/// Runs the scenario as far as needed and records the boxes of all convex parts, without skin. Shorter if the run ends
/// before. Throws InputError if the run ends before anything is recorded or the boxes do not fit into memory.
Trajectory record_boxes(const Scenario& scenario, const RecordBoxes& what, const Say& say);

}  // namespace talus
