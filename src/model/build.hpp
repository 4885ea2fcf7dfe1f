// Scenario -> Model and first State: cutting, mass properties, supports, joints of faces, initial stress.
#pragma once

#include "geometry/cut.hpp"
#include "model/model.hpp"
#include "model/state.hpp"
#include "scenario/scenario.hpp"

#include <string>
#include <vector>

namespace talus {

struct BuildReport {  // what `talus check` tells
    CutReport cut;
    int trace_count = 0, tips_extended = 0, corners_snapped = 0, trace_junctions = 0;
    std::vector<std::string> warnings;
    std::vector<int> faces_per_joint;  // [nj] touching part pairs by the joint they got, in the order of Model::joints
};

struct Scene {
    Model model;
    State state;  // contacts holds the bonded and prestressed faces; loads are zero
    BuildReport report;
};

/// Throws InputError with every fault found (overlapping blocks: which and how deep; names that fit nothing; ...).
Scene build(const Scenario& scenario);

/// All blocks where they were built, at rest, no contacts: where places of the scenario are looked up.
State state_at_start(const Model& model);

/// Blocks meant by a selector, ascending; throws InputError if there is none.
std::vector<BlockId> select(const Model& model, const State& state, const Selector& selector);

/// Loads on the selected blocks, each block with the whole force; throws InputError if a selector fits nothing. They go
/// behind the first Model::boundary_loads of Model::loads.
std::vector<Load> make_loads(const Model& model, const State& state, const std::vector<LoadSpec>& specs);

/// Joint properties ready for the law.
Joint make_joint(const JointSpec& spec);

}  // namespace talus
