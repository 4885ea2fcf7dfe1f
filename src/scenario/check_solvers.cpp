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
        if (!all_rigid && !may_be_rigid && joint["restitution"].number() > 0.0)
            joint["restitution"].fault(
                "only the rigid solver has it (run.solver: rigid); with joint stiffness blocks "
                "rebound by themselves, and damping.contact takes energy");
    }
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
    if (!last) return;
    check_accuracy(at["run"]["accuracy"]["joint_stress"]);
    for (const Cursor& history : at["record"]["history"].items()) check_observed(history, history["component"].text());
    for (const Cursor& expect : at["expect"].items()) {
        check_observed(expect, expect["component"].text());
        check_closure(expect);
    }
}

}  // namespace talus
