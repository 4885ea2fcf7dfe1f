#include "simulation/need.hpp"

#include "scenario/springs.hpp"

#include <algorithm>

namespace talus {
namespace {

bool changes(const TimeTable& table) {
    return std::any_of(table.value.begin(), table.value.end(), [&](double v) { return v != table.value.front(); });
}

/// Joints in situ that are relieved or loaded move by what they give, and by little else.
bool relieves_stress(const Scenario& scenario) {
    if (!scenario.initial_stress) return false;
    const InitialStressSpec& stress = *scenario.initial_stress;
    return stress.left || stress.right || stress.bottom || stress.top ||
           std::any_of(scenario.stages.begin(), scenario.stages.end(), [](const StageSpec& s) { return !s.remove.empty(); });
}

/// A block of which the rigid solver makes no body: bonded, and held along some axes only, or driven.
bool bonded_roller(const Model& model) {
    return std::any_of(model.faces.begin(), model.faces.end(), [&](const JointFace& face) {
        const auto partly = [&](PartId p) {
            const BlockId b = model.parts.block[p];
            const bool free = model.blocks.inv_mass[b].minCoeff() > 0.0 && model.blocks.inv_inertia[b] > 0.0;
            return !free && !model.blocks.held(b);
        };
        return face.bonded && (partly(face.part_a) || partly(face.part_b));
    });
}

const StageView* find(const std::vector<StageView>& stages, bool (*fits)(const StageView&)) {
    const auto found = std::find_if(stages.begin(), stages.end(), fits);
    return found == stages.end() ? nullptr : &*found;
}

// A stage that settles is damped only to come to rest.
bool damped(const StageView& s) {
    return s.open && !s.timeless() && !s.settle && (s.damping->contact > 0.0 || s.damping->local > 0.0);
}

bool with_springs(const StageView& s) { return *s.solver == "explicit" || *s.solver == "static"; }

bool dilates(const JointSpec& joint) { return joint.dilation_angle > 0.0; }

}  // namespace

std::vector<StageView> stages_of(Scenario& scenario) {
    std::vector<StageView> all;
    for (StageSpec& s : scenario.stages)
        all.push_back({s.name, &s.solver, &s.until, &s.damping, &s.time_step, s.settle, s.solver == "auto"});
    RunSpec& run = scenario.run;
    if (run.until.time || run.until.equilibrium || all.empty())
        all.push_back({"run", &run.solver, &run.until, &run.damping, &run.time_step, false, run.solver == "auto"});
    return all;
}

Need need_of_springs(const Scenario& s, const std::vector<StageView>& stages, const Model& model, const Burden& burden) {
    const std::string asked = asked_of_springs(s);
    if (s.run.accuracy->joint_stress) return {"the stress of joints is asked for", false};
    if (!asked.empty()) return {asked + " depends on the stiffness of joints", false};
    if (burden.speed > 0.0 && !has_restitution(s))
        return {"blocks fly, and joints without a restitution rebound by their stiffness", false};
    if (relieves_stress(s)) return {"joints under initial stress are loaded or relieved, and move by what they give", false};
    if (std::any_of(s.joints.begin(), s.joints.end(), dilates))
        return {"dilation presses on joints by their stiffness", false};
    if (const StageView* stage = find(stages, damped))
        return {"damping is given (" + stage->name + "), which acts beside springs"};
    if (bonded_roller(model)) return {"bonded blocks are driven, or held along some axes only"};
    if (const StageView* stage = find(stages, with_springs))
        return {"solver: " + *stage->solver + " is given (" + stage->name + ")"};
    return {};
}

bool takes_time(const Scenario& scenario) {
    const auto moves = [](const std::optional<TimeTable>& table) {
        return table && std::any_of(table->value.begin(), table->value.end(), [](double v) { return v != 0.0; });
    };
    return changes(scenario.body_acceleration.x) || changes(scenario.body_acceleration.y) ||
           std::any_of(scenario.blocks.begin(), scenario.blocks.end(), [&](const BlockSpec& b) {
               return moves(b.driven.velocity_x) || moves(b.driven.velocity_y) || moves(b.driven.spin);
           });
}

bool has_restitution(const Scenario& scenario) {
    return std::any_of(scenario.joints.begin(), scenario.joints.end(),
                       [](const JointSpec& j) { return j.restitution > 0.0; });
}

}  // namespace talus
