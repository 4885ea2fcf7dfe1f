// What a scenario states and the solver that it names cannot represent.
#include "scenario/convert.hpp"
#include "scenario/springs.hpp"

namespace talus {
namespace {

const std::string rigid = "rigid";

void check_observed(const Cursor& at, const std::string& component) {
    std::vector<Cursor> named = at["quantities"].items();
    named.push_back(at["quantity"]);
    for (const Cursor& quantity : named)
        if (exists_with_springs_only(quantity.text(), component))
            quantity.fault(quantity.text() + (component.empty() ? "" : "." + component) +
                           " belongs to joints with stiffness, of which the rigid solver knows nothing; it needs "
                           "run.solver: explicit");
}

// Closure is elastic: a rigid joint has none.
void check_closure(const Cursor& expect) {
    if (expect["quantity"].text() != "opening") return;
    for (const char* key : {"value", "below"})
        if (expect[key].given() && expect[key].number() < 0.0)
            expect[key].fault(
                "a joint closes by its stiffness, of which the rigid solver knows nothing; it needs run.solver: "
                "explicit");
}

void check_damping(const Cursor& stage, bool settles) {
    const Cursor local = stage["damping"]["local"], contact = stage["damping"]["contact"];
    const std::string why = ": with the rigid solver friction and impacts alone take energy; leave it out";
    if (local.number() > 0.0 && !settles) local.fault("local damping is not available" + why);
    if (contact.number() > 0.0) contact.fault("contact damping acts beside springs" + why);
}

void check_accuracy(const Cursor& stress) {
    if (stress.given())
        stress.fault(
            "the rigid solver finds one of the states that are in balance, not what joints with a stiffness carry; it needs "
            "solver: explicit or static, or auto");
}

// `may_be_rigid`: a solver is still to be chosen.
void check_joints(const Cursor& joints, bool any_rigid, bool all_rigid, bool may_be_rigid) {
    for (const auto& [name, joint] : joints.names()) {
        if (any_rigid && joint["dilation_angle_deg"].number() > 0.0)
            joint["dilation_angle_deg"].fault("the rigid solver has no dilation; solver: explicit has it");
        if (!all_rigid && !may_be_rigid && joint["restitution"].given())
            joint["restitution"].fault(
                "only the rigid solver has it (run.solver: rigid); with joint stiffness blocks "
                "rebound by themselves, and damping.contact takes energy");
    }
}

// Contacts at points carry force and friction, nothing else; solvers without springs have no use for them.
void check_rounding(const Scenario& scenario, const Cursor& at) {
    const Cursor rounding = at["run"]["rounding_length"];
    if (!rounding.given()) return;
    const std::string geometry = "the geometry of rounded corners ";
    if (!scenario.run.face_path)
        rounding.fault("run.face_path: false asks for the general form, which has sharp corners; leave one of them out");
    if (scenario.run.accuracy)
        rounding.fault("what an accuracy chooses is known for sharp corners only; leave one of them out");
    bool others = scenario.run.solver != "explicit" && scenario.run.solver != "auto";
    for (const StageSpec& stage : scenario.stages) others |= stage.solver != "explicit" && stage.solver != "auto";
    if (others)
        rounding.fault(geometry + "belongs to the explicit solver; leave it out, or use solver: explicit throughout");
    const auto check_strength = [&](const Cursor& joints) {
        for (const auto& [name, joint] : joints.names())
            for (const char* key : {"cohesion", "tension"})
                if (joint[key].number() > 0.0)
                    joint[key].fault(geometry + "(run.rounding_length) has no bonds; leave one of them out");
    };
    check_strength(at["joints"]);
    for (const Cursor& stage : at["stages"].items()) check_strength(stage["change"]["joints"]);
}

void check_substeps(const Scenario& scenario, const Cursor& substeps) {
    const auto steps = [](const std::string& solver) { return solver == "explicit" || solver == "auto"; };
    bool any = steps(scenario.run.solver);
    for (const StageSpec& stage : scenario.stages) any |= steps(stage.solver);
    if (substeps.given() && scenario.run.substeps != 1 && !any)
        substeps.fault("only the explicit solver has a step that small blocks shorten; leave it out");
}

}  // namespace

void check_solvers(const Scenario& scenario, const Cursor& at) {
    const bool last = scenario.run.solver == rigid, open = scenario.run.accuracy && scenario.run.solver == "auto";
    bool any = last, all = last;
    const std::vector<Cursor> stages = at["stages"].items();
    for (std::size_t i = 0; i < stages.size() && i < scenario.stages.size(); ++i) {
        const bool mine = scenario.stages[i].solver == rigid;
        any |= mine;
        all &= mine;
        if (!mine) continue;
        check_damping(stages[i], scenario.stages[i].settle);
        check_joints(stages[i]["change"]["joints"], true, true, false);
    }
    if (last) check_damping(at["run"], false);
    check_joints(at["joints"], any, all, open);
    check_rounding(scenario, at);
    check_substeps(scenario, at["run"]["substeps"]);
    if (!last) return;
    check_accuracy(at["run"]["accuracy"]["joint_stress"]);
    for (const Cursor& history : at["record"]["history"].items()) check_observed(history, history["component"].text());
    for (const Cursor& expect : at["expect"].items()) {
        check_observed(expect, expect["component"].text());
        check_closure(expect);
    }
}

}  // namespace talus
