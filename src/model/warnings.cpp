#include "model/warnings.hpp"

#include "core/text.hpp"
#include "model/supports.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace talus {
namespace {

std::set<std::string> joints_in_use(const Scenario& scenario) {
    std::set<std::string> used{scenario.contacts.default_joint};
    for (const auto& row : scenario.contacts.materials) used.insert(row.joint);
    for (const auto& row : scenario.contacts.blocks) used.insert(row.joint);
    if (scenario.contacts.default_joint.empty() && !scenario.joints.empty()) used.insert(scenario.joints.front().name);
    if (!scenario.rock) return used;
    for (const JointSetSpec& set : scenario.rock->joint_sets) used.insert(set.joint);
    for (const CrackSpec& crack : scenario.rock->cracks) used.insert(crack.joint);
    if (scenario.rock->traces) used.insert(scenario.rock->traces->joint);
    return used;
}

// Free blocks that share no stretch of edge with any other.
std::vector<BlockId> loose_blocks(const Model& model, const Neighbours& neighbours) {
    std::vector<std::uint8_t> touched(model.blocks.size(), 0);
    for (const auto& touch : neighbours.touches)
        touched[model.parts.block[touch.part_a]] = touched[model.parts.block[touch.part_b]] = 1;
    for (const DrivenBlock& driven : model.driven) touched[driven.block] = 1;
    std::vector<BlockId> loose;
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        if (!touched[b] && !model.blocks.held(b)) loose.push_back(b);
    return loose;
}

// What is pressed is pressed by overlap x stiffness: a stage that changes the stiffness changes the force.
void stiffness_of_stages(const Scenario& scenario, std::vector<std::string>& all) {
    std::vector<JointSpec> now = scenario.joints;
    for (const StageSpec& stage : scenario.stages)
        for (const JointSpec& joint : stage.joints)
            for (JointSpec& before : now) {
                if (before.name != joint.name) continue;
                const double ratio = joint.normal_stiffness / before.normal_stiffness;
                if (stage.solver != "rigid" && std::isfinite(ratio) && ratio > 0.0 && ratio != 1.0)
                    all.push_back(
                        "stage " + stage.name + " multiplies the normal stiffness of joint `" + joint.name + "` by " +
                        number(ratio) +
                        ": forces that are the stiffness times an overlap go with it, and blocks move until they are in "
                        "balance again; forces by initial stress and shear forces stay");
                before = joint;
            }
}

void velocities_of_held(const Scenario& scenario, std::vector<std::string>& all) {
    for (const BlockSpec& block : scenario.blocks)
        if ((block.held.x && block.velocity.x() != 0.0) || (block.held.y && block.velocity.y() != 0.0) ||
            (block.held.rotation && block.spin != 0.0))
            all.push_back("block `" + block.name +
                          "` is held along an axis in which it has a velocity: it stays where it is");
}

bool something_holds(const Model& model) {
    const auto& inverse = model.blocks.inv_mass;
    return std::any_of(inverse.begin(), inverse.end(), [](const Vec2& m) { return m.x() == 0.0 || m.y() == 0.0; });
}

}  // namespace

std::vector<std::string> warnings(const Scenario& scenario, const Model& model, const Neighbours& neighbours,
                                  const Prestress& prestress, const std::vector<int>& faces_per_joint) {
    std::vector<std::string> all;
    const std::set<std::string> used = joints_in_use(scenario);
    for (std::size_t j = 0; j < model.joints.size(); ++j) {
        const Joint& joint = model.joints[j];
        if (!used.contains(joint.name))
            all.push_back("joint `" + joint.name + "` is never used");
        else if ((joint.tension > 0.0 || joint.cohesion > 0.0) && faces_per_joint[j] == 0)
            all.push_back("joint `" + joint.name + "` has strength to bond blocks, but none touch along it at the start");
    }
    if (!something_holds(model) && model.boundary_loads == 0 && scenario.gravity(0.0).norm() > 0.0)
        all.push_back("no block is held or driven: under gravity the whole scene falls");
    if (model.blocks.size() > 1)
        if (const auto loose = loose_blocks(model, neighbours); !loose.empty())
            all.push_back(std::to_string(loose.size()) +
                          " free block(s) share no edge with another at the start, the first at " +
                          place(model.blocks.start[loose.front()] + model.origin));
    if (prestress.beyond_strength > 0)
        all.push_back("initial stress is beyond the strength of the joint on " + std::to_string(prestress.beyond_strength) +
                      " face(s): they will slip or open at once");
    if (prestress.tension_dropped > 0)
        all.push_back("initial stress pulls on " + std::to_string(prestress.tension_dropped) +
                      " face(s) whose joint has no tension: set to zero there");
    stiffness_of_stages(scenario, all);
    velocities_of_held(scenario, all);
    const double length = model.rounding_length;
    if (const auto less = std::ranges::count_if(model.corners.cut, [&](double cut) { return cut < length; }); less > 0)
        all.push_back(std::to_string(less) +
                      " corner(s) are rounded from less than the rounding length, because an edge or the block is too "
                      "small, the least from " +
                      number(*std::ranges::min_element(model.corners.cut)) + " m");
    return all;
}

}  // namespace talus
