// The rock of a scenario, cut into shapes.
#pragma once

#include "geometry/cut.hpp"
#include "geometry/polygon.hpp"
#include "model/shapes.hpp"
#include "scenario/scenario.hpp"

#include <string>
#include <vector>

namespace talus {

struct CutRock {
    std::vector<Shape> shapes;
    std::vector<CutSeam> seams;                // left and right are indices of shapes
    std::vector<std::string> joint_of_source;  // name of the joint of each joint set, crack, trace map; empty = by materials
    Box outline;                               // m, extremes of the outline
    CutReport report;
    int trace_count = 0, tips_extended = 0, corners_snapped = 0, trace_junctions = 0;
};

/// Cuts the rock along everything it names. material_names: for the indices in the shapes.
CutRock cut_rock(const RockSpec& rock, const std::vector<std::string>& material_names);

}  // namespace talus
