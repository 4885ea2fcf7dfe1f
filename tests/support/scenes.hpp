// Small scenarios made in code, for tests of what lies behind the reader.
#pragma once

#include "scenario/scenario.hpp"

#include <cmath>
#include <string>

namespace talus::scenes {

inline Polygon rectangle(double x0, double y0, double x1, double y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }

inline BlockSpec block(const std::string& name, const Polygon& outline) {
    BlockSpec spec;
    spec.name = name;
    spec.outline = outline;
    spec.material = "rock";
    return spec;
}

inline BlockSpec held(BlockSpec spec) {
    spec.held = {true, true, true};
    return spec;
}

inline JointSpec joint(const std::string& name, double friction_angle_deg = 30.0) {
    JointSpec spec;
    spec.name = name;
    spec.normal_stiffness = 1e10;
    spec.shear_stiffness = 5e9;
    spec.friction_angle = radians(friction_angle_deg);
    return spec;
}

inline JointSpec bonded_joint(const std::string& name, double cohesion, double tension) {
    JointSpec spec = joint(name);
    spec.cohesion = cohesion;
    spec.tension = tension;
    return spec;
}

/// Gravity 10 m/s2 downwards, one material `rock` of 2500 kg/m3, one joint `plain` everywhere, no block yet.
inline Scenario empty() {
    Scenario scene;
    scene.gravity = {TimeTable::constant(0.0), TimeTable::constant(-10.0)};
    scene.materials = {{"rock", 2500.0}};
    scene.joints = {joint("plain")};
    scene.contacts.default_joint = "plain";
    return scene;
}

inline Scenario with(std::vector<BlockSpec> blocks) {
    Scenario scene = empty();
    scene.blocks = std::move(blocks);
    return scene;
}

inline JointSetSpec joint_set(double angle_deg, double spacing, const std::string& joint = {}) {
    JointSetSpec set;
    set.angle.mean = radians(angle_deg);
    set.spacing.mean = spacing;
    set.joint = joint;
    return set;
}

/// A rock of the given outline, cut by joint sets.
inline Scenario rock(const Polygon& outline, std::vector<JointSetSpec> sets) {
    Scenario scene = empty();
    scene.rock.emplace();
    scene.rock->outline = outline;
    scene.rock->material = "rock";
    scene.rock->joint_sets = std::move(sets);
    return scene;
}

inline Polygon shifted(Polygon polygon, const Vec2& by) {
    for (Vec2& p : polygon) p += by;
    return polygon;
}

inline Polygon turned(Polygon polygon, double angle_deg) {
    const double c = std::cos(radians(angle_deg)), s = std::sin(radians(angle_deg));
    for (Vec2& p : polygon) p = Vec2(c * p.x() - s * p.y(), s * p.x() + c * p.y());
    return polygon;
}

}  // namespace talus::scenes
