#include "scenario/check.hpp"
#include "scenario/convert.hpp"
#include "scenario/specification.hpp"

#include <set>

namespace talus {
namespace {

// `at`: of the stage, or run.
Until convert_until(const Cursor& at, const std::string& solver) {
    const Cursor until = at["until"];
    Until found{until["time"].maybe_number(), until["equilibrium"].maybe_number(), {}, until["verdict"].yes()};
    if (const auto iterations = until["iterations"].maybe_number()) found.iterations = static_cast<int>(*iterations);
    if (found.verdict && solver != "static" && !found.time)
        until["verdict"].fault("needs `time`, the most that is computed: some scenes stay undecided");
    if (solver == "static" && found.time && !found.equilibrium)
        until.fault("needs `equilibrium`: no time passes in a static stage, it ends in equilibrium");
    if (solver != "static" && found.iterations) until["iterations"].fault("is for a static stage; others end by `time`");
    return found;
}

DampingSpec convert_damping(const Cursor& at) { return {at["local"].number(), at["contact"].number()}; }

// Keys of `change` go over those of `joint`, table by table.
void merge(Value& joint, const Value& change) {
    for (const Entry& entry : change.entries) {
        Value* old = joint.find(entry.key);
        if (old && old->is(Value::Kind::map) && entry.value.is(Value::Kind::map))
            merge(*old, entry.value);
        else if (!entry.value.is(Value::Kind::none))
            joint.set(entry.key, entry.value, entry.line);
    }
}

/// The joints that a stage changes, complete. `joints` holds their keys so far and is brought up to date.
std::vector<JointSpec> convert_changes(const Cursor& changes, Value& joints) {
    std::vector<JointSpec> all;
    for (const auto& [name, change] : changes.names()) {
        Value* joint = joints.find(name);
        if (!joint) {
            Value text = Value::of_text(name);
            text.kind = Value::Kind::text;
            Cursor(text, change.path(), change.where().line, change.reading()).name_of("joint", change.reading().joints);
            continue;
        }
        merge(*joint, change.value());
        all.push_back(convert_joint(name, Cursor(*joint, change.path(), change.where().line, change.reading())));
    }
    return all;
}

StageSpec convert_stage(const Cursor& at, const std::string& solver_of_run, Value& joints) {
    StageSpec stage;
    stage.name = at["name"].text();
    stage.solver = at["solver"].given() ? at["solver"].text() : solver_of_run;
    stage.settle = at["settle"].yes();
    stage.reset = at["reset"].yes();
    for (const Cursor& selector : at["delete"].items()) stage.remove.push_back(convert_selector(selector));
    stage.release = at["release"].number();
    stage.joints = convert_changes(at["change"]["joints"], joints);
    if (at["gravity"].given()) stage.gravity = at["gravity"].vector_table();
    stage.loads = convert_loads(at["loads"]);
    stage.loads_given = at["loads"].given();
    if (!at["until"].given()) at["until"].fault("is missing: when the stage ends");
    stage.until = convert_until(at, stage.solver);
    if (stage.until.verdict) at["until"]["verdict"].fault("goes with `run`: what follows a stage changes the scene");
    stage.damping = convert_damping(at["damping"]);
    stage.time_step = at["time_step"].maybe_number();
    stage.time_step_where = at["time_step"].where();
    if (stage.release > 0.0 && stage.remove.empty())
        at["release"].fault("there is nothing to release: the stage deletes no blocks");
    if (stage.until.time && stage.solver != "static" && stage.release > *stage.until.time)
        at["release"].fault("is longer than the stage (until.time), at whose end all that is left would be let go at once");
    return stage;
}

AccuracySpec convert_accuracy(const Cursor& at) {
    const bool plain = at.is(Value::Kind::number);
    return {plain ? at.maybe_number() : at["motion"].maybe_number(), at["joint_stress"].maybe_number(), at.where()};
}

int convert_substeps(const Cursor& at) {
    if (!at.is(Value::Kind::number)) return 0;
    const int count = static_cast<int>(at.number());
    if ((count & (count - 1)) != 0) at.fault("is not a power of two: 1, 2, 4, 8, or auto");
    return count;
}

}  // namespace

std::vector<StageSpec> convert_stages(const Cursor& scenario) {
    std::vector<StageSpec> all;
    std::set<std::string> names;
    Value joints = scenario["joints"].value();
    const std::string solver = scenario["run"]["solver"].text();
    for (const Cursor& at : scenario["stages"].items()) {
        all.push_back(convert_stage(at, solver, joints));
        if (!names.insert(all.back().name).second) at["name"].fault("a stage of this name is there already");
    }
    return all;
}

RunSpec convert_run(const Cursor& at) {
    RunSpec run;
    if (at["accuracy"].given()) run.accuracy = convert_accuracy(at["accuracy"]);
    run.solver = at["solver"].text();
    run.until = convert_until(at, run.solver);
    run.time_step = at["time_step"].maybe_number();
    run.time_step_where = at["time_step"].where();
    run.step_fraction_given = at["step_fraction"].given();
    if (run.step_fraction_given) run.step_fraction = at["step_fraction"].number();
    run.unchecked = at["unchecked"].yes();
    run.damping = convert_damping(at["damping"]);
    run.smallest_failure = at["smallest_failure"].maybe_number().value_or(run.smallest_failure);
    run.freeze = at["freeze"].maybe_number();
    run.freeze_given = at["freeze"].given();
    run.substeps = convert_substeps(at["substeps"]);
    run.search = at["search"].text();
    run.skin = at["skin"].maybe_number();
    run.face_path = at["face_path"].yes();
    run.rounding_length = at["rounding_length"].maybe_number();
    run.rounding_where = at["rounding_length"].where();
    run.threads = static_cast<int>(at["threads"].number());
    return run;
}

}  // namespace talus
