#include "model/initial_stress.hpp"

#include "model/supports.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace talus {
namespace {

Eigen::Matrix2d tensor(const Eigen::Vector3d& xx_yy_xy) {
    Eigen::Matrix2d s;
    s << xx_yy_xy[0], xx_yy_xy[2], xx_yy_xy[2], xx_yy_xy[1];
    return s;
}

// Stress below this share of the largest one is rounding and counts as none; ten times less would still catch it.
constexpr double rounding_share = 1e-12;
// A stress this much above the strength is rounding, not a fault of the scene.
constexpr double strength_margin = 1e-9;

struct FaceStress {
    double sigma0 = 0.0, sigma1 = 0.0;  // Pa, normal stress at the two ends
    double shear = 0.0;                 // Pa, mean
    bool none() const { return sigma0 == 0.0 && sigma1 == 0.0 && shear == 0.0; }
    double largest() const { return std::max({std::abs(sigma0), std::abs(sigma1), std::abs(shear)}); }
};

FaceStress traction(const StressField& field, const Vec2& from, const Vec2& to, const Vec2& normal) {
    const Vec2 t0 = field(from) * normal, t1 = field(to) * normal;
    return {normal.dot(t0), normal.dot(t1), perp(normal).dot(t0 + t1) / 2.0};
}

bool beyond_strength(const FaceStress& stress, const Joint& joint) {
    const double normal = (stress.sigma0 + stress.sigma1) / 2.0;
    const double limit = joint.cohesion + std::max(normal, 0.0) * joint.tan_friction;
    return std::abs(stress.shear) > limit * (1.0 + strength_margin) ||
           std::min(stress.sigma0, stress.sigma1) < -joint.tension * (1.0 + strength_margin);
}

const InitialStressSpec::OnJoint* given_on(const InitialStressSpec& spec, const std::string& joint) {
    const auto at =
        std::find_if(spec.joints.begin(), spec.joints.end(), [&](const auto& row) { return row.joint == joint; });
    return at == spec.joints.end() ? nullptr : &*at;
}

std::pair<Vec2, Vec2> ends(const Model& model, std::span<const Vec2> corner, const Neighbours::Touch& touch) {
    const Vec2 along = perp(model.corners.normal[touch.edge_a]);
    return {corner[touch.edge_a] + touch.s0 * along, corner[touch.edge_a] + touch.s1 * along};
}

// Given joint by joint or else by the field; nothing without a spec.
std::vector<FaceStress> stress_on(const Model& model, const std::vector<Neighbours::Touch>& touches,
                                  std::span<const int> joint, std::span<const Vec2> corner, const InitialStressSpec* spec,
                                  const StressField& field) {
    std::vector<FaceStress> all(touches.size());
    if (spec == nullptr) return all;
    double largest = 0.0;
    for (std::size_t i = 0; i < touches.size(); ++i) {
        const auto* given = given_on(*spec, model.joints[joint[i]].name);
        const auto [from, to] = ends(model, corner, touches[i]);
        all[i] = given ? FaceStress{given->normal, given->normal, given->shear}
                       : traction(field, from, to, model.corners.normal[touches[i].edge_a]);
        largest = std::max(largest, all[i].largest());
    }
    for (FaceStress& stress : all)
        for (double* part : {&stress.sigma0, &stress.sigma1, &stress.shear})
            if (std::abs(*part) < rounding_share * largest) *part = 0.0;
    return all;
}

// What the field puts on an edge from outside. It is linear along the edge and so is the arm: Simpson's rule is exact.
Force edge_load(const StressField& field, const Vec2& from, const Vec2& to, const Vec2& normal, const Vec2& centroid) {
    const double length = (to - from).norm();
    Force load;
    for (const auto& [share, weight] : {std::pair(0.0, 1.0), std::pair(0.5, 4.0), std::pair(1.0, 1.0)}) {
        const Vec2 at = from + share * (to - from);
        const Vec2 push = -weight / 6.0 * length * (field(at) * normal);  // from outside on the block: against its normal
        load.force += push;
        load.torque += cross(at - centroid, push);
    }
    return load;
}

}  // namespace

StressField stress_field(const InitialStressSpec& spec, double rock_weight, double top) {
    StressField field;
    if (spec.stress) {
        field.at_reference = tensor(*spec.stress);
        field.per_x = tensor(spec.gradient_x);
        field.per_y = tensor(spec.gradient_y);
    } else if (spec.k0) {
        const Eigen::Vector3d one_vertical(*spec.k0, 1.0, 0.0);
        field.reference = {0.0, spec.surface.value_or(top)};
        field.at_reference = spec.surcharge * tensor(one_vertical);
        field.per_y = -spec.unit_weight.value_or(rock_weight) * tensor(one_vertical);
    }
    return field;
}

Prestress make_faces(const Model& model, const std::vector<Neighbours::Touch>& touches, std::span<const int> joint,
                     std::span<const Vec2> corner, const InitialStressSpec* spec, const StressField& field) {
    const std::vector<FaceStress> stresses = stress_on(model, touches, joint, corner, spec, field);
    const std::vector<std::uint8_t> fixed = immovable(model);
    Prestress all;
    int cells = 0;
    for (std::size_t i = 0; i < touches.size(); ++i) {
        const Neighbours::Touch& touch = touches[i];
        const BlockId a = model.parts.block[touch.part_a], b = model.parts.block[touch.part_b];
        if (fixed[a] && fixed[b]) continue;
        const Joint& acting = model.joints[joint[i]];
        FaceStress stress = stresses[i];
        if (acting.tension <= 0.0 && std::min(stress.sigma0, stress.sigma1) < 0.0) {
            stress.sigma0 = std::max(stress.sigma0, 0.0);
            stress.sigma1 = std::max(stress.sigma1, 0.0);
            ++all.tension_dropped;
        }
        const bool bonded = acting.tension > 0.0 || acting.cohesion > 0.0;
        if (!bonded && stress.none()) continue;
        if (beyond_strength(stress, acting)) ++all.beyond_strength;
        all.faces.push_back({touch.part_a, touch.part_b, touch.edge_a, touch.edge_b, joint[i], cells, bonded, touch.s0,
                             touch.s1, stress.sigma0, stress.sigma1});
        all.shear_force.push_back(stress.shear * (touch.s1 - touch.s0));
        cells += acting.cells;
    }
    return all;
}

std::vector<Contact> first_contacts(const Model& model, std::span<const double> shear_force) {
    std::vector<Contact> contacts;
    for (std::size_t i = 0; i < model.faces.size(); ++i) {
        const JointFace& face = model.faces[i];
        const double sum = face.sigma0 + face.sigma1, length = face.s1 - face.s0;
        // Centre of a pressure that varies linearly; the middle if there is none or it changes sign.
        const bool one_sign = sum != 0.0 && face.sigma0 * face.sigma1 >= 0.0;
        const double share = one_sign ? (face.sigma0 + 2.0 * face.sigma1) / (3.0 * sum) : 0.5;
        Contact contact{.part_a = face.part_a, .part_b = face.part_b, .joint = face.joint};
        contact.face = static_cast<int>(i);
        contact.edge_a = face.edge_a;
        contact.edge_b = face.edge_b;
        contact.touching = sum != 0.0 || shear_force[i] != 0.0;
        contact.alive = 1;
        contact.length = length;
        contact.normal_force = 0.5 * sum * length;
        contact.shear_force = shear_force[i];
        contact.shear_energy = 0.5 * shear_force[i] * shear_force[i] / (model.joints[face.joint].ks * (face.s1 - face.s0));
        contact.normal = model.corners.normal[face.edge_a];
        contact.point = model.blocks.start[model.parts.block[face.part_a]] + model.corners.arm[face.edge_a] +
                        (face.s0 + share * length) * perp(contact.normal);
        contacts.push_back(contact);
    }
    return contacts;
}

std::vector<Load> boundary_loads(const Model& model, const InitialStressSpec& spec, const StressField& field,
                                 std::span<const Vec2> corner, std::span<const std::uint8_t> covered, int blocks,
                                 const Box& outline) {
    const std::array<bool, 4> loaded{spec.left, spec.right, spec.bottom, spec.top};
    std::map<BlockId, Force> sum;
    for (int i = 0; i < 4; ++i) {
        if (!loaded[i]) continue;
        for (const OuterEdge& edge : edges_on_side(model, corner, blocks, outline, sides[i])) {
            if (covered[edge.corner] || model.blocks.held(edge.block)) continue;
            const Force load = edge_load(field, corner[edge.corner], corner[edge.next], model.corners.normal[edge.corner],
                                         model.blocks.start[edge.block]);
            sum[edge.block].force += load.force;
            sum[edge.block].torque += load.torque;
        }
    }
    std::vector<Load> loads;
    for (const auto& [block, load] : sum)
        loads.push_back({block, Vec2::Zero(), TimeTable::constant(load.force.x()), TimeTable::constant(load.force.y()),
                         TimeTable::constant(load.torque)});
    return loads;
}

}  // namespace talus
