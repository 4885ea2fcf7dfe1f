// Which joint acts where: the tables of the model, filled from the scenario.
#pragma once

#include "core/errors.hpp"
#include "geometry/cut.hpp"
#include "model/model.hpp"
#include "model/neighbours.hpp"
#include "scenario/scenario.hpp"

#include <string>
#include <vector>

namespace talus {

/// Index of a joint, -1 if no joint has that name.
int joint_index(const Model& model, const std::string& name);

/// Fills joints, default_joint, joint_of_materials and joint_of_blocks; blocks and material_names are ready. Adds to
/// `faults` what names nothing.
void fill_joint_tables(const Scenario& scenario, Model& model, std::vector<Fault>& faults);

/// Fills joint_of_faces: touching parts get the joint of the seam that covers most of their common stretch.
/// corner[nc]: as given, m; seams name the first blocks of the model; joint_of_source[i]: index of the joint of source i,
/// -1 = none of its own; tolerance: m, how far a seam may lie beside an edge.
void fill_joint_of_faces(std::span<const Neighbours::Touch> touches, std::span<const Vec2> corner,
                         std::vector<CutSeam> seams, std::span<const int> joint_of_source, double tolerance, Model& model);

}  // namespace talus
