#include "simulation/need.hpp"

#include "scenario/springs.hpp"

#include <algorithm>
#include <limits>

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

bool calms(const StageView& s) { return s.until->equilibrium || s.damping->contact > 0.0 || s.damping->local > 0.0; }

/// Whether the end of the run finds blocks at rest, if anything does.
bool comes_to_rest(const Scenario& scenario, const std::vector<StageView>& stages) {
    return calms(stages.back()) && !takes_time(scenario);
}

/// Share of a block by which the top comes down on the joints whose stiffness is given, under what lies still on them.
double settlement(const Scenario& scenario, const Burden& burden) {
    double least = std::numeric_limits<double>::infinity();
    for (const JointSpec& joint : scenario.joints)
        if (joint.normal_stiffness > 0.0) least = std::min(least, joint.normal_stiffness);
    return burden.stress / (least * burden.mean_size) * std::max(1.0, 0.5 * burden.layers);
}

// What is let go at once goes twice as far as what is set down.
constexpr double overshoot = 2.0;

/// What is asked for of which the give of joints is part; the why is empty if there is nothing of the kind.
Need need_of_give(const Scenario& s, const std::vector<StageView>& stages, const Burden& burden) {
    const auto answer = [](const std::string& why) { return Need{why, false, false, true}; };
    if (const std::string give = asked_of_give(s); !give.empty())
        return answer(give + " depends on the stiffness of joints");
    if (const std::string small = asked_below(s, overshoot * settlement(s, burden), burden.mean_size); !small.empty())
        return answer(small + " is no more than joints close");
    // Blocks that are lifted bounce, and how much of the lift they keep is a matter of stiffness however large it is.
    if (std::any_of(s.joints.begin(), s.joints.end(), dilates))
        return answer("dilation presses on joints by their stiffness");
    const std::string asked = asked_of_forces(s);
    const bool stress = s.run.accuracy->joint_stress.has_value();
    const bool forces = (stress || !asked.empty()) && comes_to_rest(s, stages);
    const std::string relieved = "joints under initial stress are loaded or relieved, and move by what they give";
    if (relieves_stress(s) && !(forces && asked_of_movements(s).empty())) return answer(relieved);
    if (!stress && asked.empty()) return {};
    const std::string why = stress ? "the stress of joints is asked for" : asked + " depends on the stiffness of joints";
    return forces ? Need{.why = why, .give_is_error = false, .at_rest = true} : answer(why);
}

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
    if (Need need = need_of_give(s, stages, burden); !need.why.empty()) return need;
    if (burden.speed > 0.0 && !has_restitution(s)) {
        const bool calmed = std::any_of(stages.begin(), stages.end(), calms);
        return {.why = "blocks fly, and joints without a restitution rebound by their stiffness",
                .give_is_error = false,
                .open_is_error = false,
                .remedy =
                    calmed ? "" : "state a restitution of the joints (0: none), with which the rigid solver takes impacts"};
    }
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
                       [](const JointSpec& j) { return j.restitution.has_value(); });
}

bool rebounds(const Scenario& scenario) {
    return std::any_of(scenario.joints.begin(), scenario.joints.end(),
                       [](const JointSpec& j) { return j.restitution.value_or(0.0) > 0.0; });
}

}  // namespace talus
