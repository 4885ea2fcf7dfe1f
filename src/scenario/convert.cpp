// Materials, joints, contacts, loads, initial stress; and the order of the whole.
#include "scenario/convert.hpp"

#include "scenario/nearest.hpp"
#include "scenario/outline.hpp"

#include <algorithm>

namespace talus {
namespace {

void check_joint(const Cursor& joint) {
    const auto above = [](const Cursor& lower, const Cursor& upper, const std::string& message) {
        if (lower.given() && upper.given() && lower.number() > upper.number()) lower.fault(message);
    };
    above(joint["dilation_angle_deg"], joint["friction_angle_deg"],
          "is above the friction angle: shearing would gain energy");
    above(joint["dilation_angle_deg"], joint["residual"]["friction_angle_deg"],
          "is above the residual friction angle: shearing would gain energy");
    for (const char* key : {"friction_angle_deg", "cohesion"})
        above(joint["residual"][key], joint[key], "is above the peak value");
}

std::vector<ContactSpec::Between> convert_pairs(const Cursor& pairs, bool blocks) {
    std::vector<ContactSpec::Between> all;
    const Reading& reading = pairs.reading();
    const auto side = [&](const Cursor& name) {
        return blocks ? convert_block_name(name) : name.name_of("material", reading.materials);
    };
    for (const Cursor& pair : pairs.items())
        all.push_back({side(pair["a"]), side(pair["b"]), pair["joint"].name_of("joint", reading.joints)});
    return all;
}

Eigen::Vector3d triple(const Cursor& at) {
    const std::vector<double> v = at.numbers();
    return v.size() == 3 ? Eigen::Vector3d(v[0], v[1], v[2]) : Eigen::Vector3d(Eigen::Vector3d::Zero());
}

void check_scene(const Scenario& scenario, const Cursor& at) {
    const Cursor blocks = at["blocks"], joints = at["joints"];
    if (!scenario.rock && blocks.given() && blocks.value().items.empty()) blocks.fault("there are no blocks");
    if ((!scenario.rock && scenario.blocks.size() < 2) || !joints.given()) return;
    if (joints.names().empty()) joints.fault("is missing: blocks that touch need at least one joint");
    if (joints.names().size() > 1 && !at["contacts"]["default"].given())
        at["contacts"]["default"].fault("is missing: there are several joints (" + enumerate(at.reading().joints) + ")");
}

}  // namespace

std::vector<MaterialSpec> convert_materials(const Cursor& materials) {
    std::vector<MaterialSpec> all;
    for (const auto& [name, material] : materials.names()) all.push_back({name, material["density"].number()});
    return all;
}

JointSpec convert_joint(const std::string& name, const Cursor& at) {
    JointSpec joint;
    joint.name = name;
    joint.where = at.where();
    joint.normal_stiffness = at["normal_stiffness"].number();
    joint.shear_stiffness = at["shear_stiffness"].number();
    joint.friction_angle = at["friction_angle_deg"].angle();
    joint.cohesion = at["cohesion"].number();
    joint.tension = at["tension"].number();
    joint.dilation_angle = at["dilation_angle_deg"].angle();
    joint.dilation_cutoff_slip = at["dilation_cutoff_slip"].maybe_number();
    joint.restitution = at["restitution"].maybe_number();
    joint.cells = static_cast<int>(at["cells"].number());
    if (const Cursor residual = at["residual"]; residual.given()) {
        const Cursor friction = residual["friction_angle_deg"];
        joint.residual = {friction.given() ? friction.angle() : joint.friction_angle, residual["cohesion"].number()};
    }
    check_joint(at);
    return joint;
}

ContactSpec convert_contacts(const Cursor& at) {
    return {at["default"].name_of("joint", at.reading().joints), convert_pairs(at["materials"], false),
            convert_pairs(at["blocks"], true)};
}

std::string convert_block_name(const Cursor& name) {
    const Reading& reading = name.reading();
    const auto called = [&](const std::string& block) {
        return block == name.text() || block.starts_with(name.text() + "[");
    };
    if (std::any_of(reading.blocks.begin(), reading.blocks.end(), called)) return name.text();
    std::vector<std::string> known = reading.blocks;
    known.insert(known.end(), reading.regions.begin(), reading.regions.end());
    return name.name_of("block", known);
}

Selector convert_selector(const Cursor& at) {
    Selector selector;
    selector.where = at.where();
    selector.key = at.path();
    if (at.is(Value::Kind::text)) {
        selector.block = convert_block_name(at);
    } else if (at.is(Value::Kind::list)) {
        selector.at = at.point();
    } else {
        if (at["block"].given()) selector.block = convert_block_name(at["block"]);
        selector.region = at["region"].name_of("region", at.reading().regions);
        selector.at = at["at"].maybe_point();
        selector.inside = read_region_at(at["inside"]);
    }
    return selector;
}

std::vector<LoadSpec> convert_loads(const Cursor& loads) {
    std::vector<LoadSpec> all;
    for (const Cursor& load : loads.items())
        all.push_back({convert_selector(load["block"]), load["force"].vector_table(), load["moment"].time_table(),
                       load["point"].maybe_point()});
    return all;
}

InitialStressSpec convert_initial_stress(const Cursor& at) {
    InitialStressSpec stress;
    const Vec2 origin = at.reading().origin;
    stress.k0 = at["k0"].maybe_number();
    if (at["surface"].given()) stress.surface = at["surface"].number() - origin.y();
    stress.surcharge = at["surcharge"].number();
    stress.unit_weight = at["unit_weight"].maybe_number();
    stress.gradient_x = triple(at["gradient_x"]);
    stress.gradient_y = triple(at["gradient_y"]);
    // The file gives the stress at its own (0, 0), the scenario at the origin that was subtracted.
    if (at["stress"].given())
        stress.stress = triple(at["stress"]) + origin.x() * stress.gradient_x + origin.y() * stress.gradient_y;
    for (const Cursor& joint : at["joints"].items())
        stress.joints.push_back(
            {joint["joint"].name_of("joint", at.reading().joints), joint["normal"].number(), joint["shear"].number()});
    stress.left = at["left"].yes();
    stress.right = at["right"].yes();
    stress.bottom = at["bottom"].yes();
    stress.top = at["top"].yes();
    return stress;
}

Scenario convert(const Cursor& at) {
    Reading& reading = at.reading();
    for (const auto& [name, material] : at["materials"].names()) reading.materials.push_back(name);
    for (const auto& [name, joint] : at["joints"].names()) reading.joints.push_back(name);
    for (const auto& [name, region] : at["rock"]["regions"].names()) reading.regions.push_back(name);

    Scenario scenario;
    scenario.title = at["title"].text();
    scenario.source = at["source"].text();
    scenario.file = reading.file;
    scenario.folder = reading.folder;
    scenario.origin = reading.origin;
    scenario.gravity = at["gravity"].vector_table();
    scenario.body_acceleration = at["body_acceleration"].vector_table();
    scenario.materials = convert_materials(at["materials"]);
    for (const auto& [name, joint] : at["joints"].names()) scenario.joints.push_back(convert_joint(name, joint));
    if (at["rock"].given()) scenario.rock = convert_rock(at["rock"]);
    scenario.blocks = convert_blocks(at["blocks"]);
    for (const BlockSpec& block : scenario.blocks) reading.blocks.push_back(block.name);
    scenario.contacts = convert_contacts(at["contacts"]);
    scenario.loads = convert_loads(at["loads"]);
    if (at["initial_stress"].given()) scenario.initial_stress = convert_initial_stress(at["initial_stress"]);
    scenario.stages = convert_stages(at);
    scenario.run = convert_run(at["run"]);
    scenario.record = convert_record(at["record"]);
    scenario.expect = convert_expect(at["expect"]);
    check_scene(scenario, at);
    check_solvers(scenario, at);
    return scenario;
}

}  // namespace talus
