#include "contact/tangent.hpp"

#include "contact/distance_potential.hpp"
#include "contact/face_path.hpp"
#include "contact/joint_memory.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

// A factorisation that takes half of an unsymmetric matrix loses this much with each step of Newton: four digits are gained.
constexpr double negligible = 1e-4;
constexpr double evenly = 1e-6;  // how near the sheared length must be to the loaded one to shrink with it

class Assembly {
public:
    Assembly(Matrix6& stiffness, const Vec2& d) : stiffness_(stiffness), d_(d) {}

    // What a force (or a displacement) of b against a at a point counts for on both blocks.
    Vector6 pair(const Vec2& at, const Vec2& direction) const {
        Vector6 all;
        all << -direction, -cross(at, direction), direction, cross(at - d_, direction);
        return all;
    }
    void add(double k, const Vector6& force, const Vector6& measure) { stiffness_ += k * force * measure.transpose(); }

    // The force turns with the mean of both blocks, and its point moves with the mean of both.
    void turn_along(const Vec2& at, const Vec2& force) {
        const Vec2 turned = 0.5 * perp(force), arm_b = at - d_;
        for (const int angle : {2, 5}) stiffness_.col(angle) -= pair(at, turned);
        Vector6 point_x = Vector6::Zero(), point_y = Vector6::Zero();  // displacement of the point
        point_x << 0.5, 0.0, -0.5 * at.y(), 0.5, 0.0, -0.5 * arm_b.y();
        point_y << 0.0, 0.5, 0.5 * at.x(), 0.0, 0.5, 0.5 * arm_b.x();
        const Vector6 lever = point_x * force.y() - point_y * force.x();
        stiffness_.row(2) += lever.transpose();
        stiffness_.row(5) -= lever.transpose();
        stiffness_(2, 0) -= force.y(), stiffness_(2, 1) += force.x();
        stiffness_(5, 3) += force.y(), stiffness_(5, 4) -= force.x();
    }

private:
    Matrix6& stiffness_;
    Vec2 d_;  // m, from the centroid of a to that of b
};

PressedSprings springs_of(const Model& model, const Placed& placed, std::span<const std::uint8_t> broken, const Contact& now,
                          const Vec2& d) {
    const PlacedPart a(model, placed, now.part_a), b(model, placed, now.part_b);
    const Vec2 at = d - now.dilation * now.normal;
    PressedSprings found;
    if (now.edge_a < 0 || now.edge_b < 0) {
        distance_potential_springs(a, b, at.x(), at.y(), found);
    } else if (now.face < 0) {
        face_springs(a, b, at.x(), at.y(), now.edge_a - a.first, now.edge_b - b.first, nullptr, found);
    } else {
        const JointFace& face = model.faces[now.face];
        const FaceMemory memory = joint_memory(face, model.joints[now.joint], broken);
        face_springs(a, b, at.x(), at.y(), face.edge_a - a.first, face.edge_b - b.first, &memory, found);
    }
    return found;
}

}  // namespace

Tangent contact_tangent(const Model& model, const Placed& placed, std::span<const std::uint8_t> broken,
                        const Contact& contact, const Reaction& reaction, Shear shear) {
    const PlacedBlock& a = placed.block[model.parts.block[contact.part_a]];
    const PlacedBlock& b = placed.block[model.parts.block[contact.part_b]];
    const Vec2 d = b.position - a.position, n = contact.normal, at = contact.point - a.position;
    const Joint& joint = model.joints[contact.joint];
    Tangent tangent;
    Assembly sum(tangent.stiffness, d);
    const PressedSprings pressed = springs_of(model, placed, broken, contact, d);

    // Times a displacement: by how much the normal force, and the loaded length, become smaller.
    Vector6 normal = Vector6::Zero(), length = Vector6::Zero();
    for (const PressedSpring& s : pressed.springs) {
        const Vector6 measure = sum.pair(s.at, s.measure);
        sum.add(joint.kn * s.length, sum.pair(s.at, s.force), measure);
        normal += joint.kn * s.length * s.force.dot(n) * measure;
    }
    for (const OpenEnd& end : pressed.ends) length += end.per_closure * sum.pair(end.at, n);

    const Vector6 along = sum.pair(at, perp(n)), across = sum.pair(at, n);
    const double ks = joint.ks * contact.length, force = contact.shear_force;
    const bool held_by_friction = shear == Shear::sticks && contact.strength > 0.0;
    if (!contact.sliding || held_by_friction) {
        sum.add(ks, along, along);
        const bool even = force * force >= (1.0 - evenly) * 2.0 * ks * contact.shear_energy;
        if (even && !held_by_friction) sum.add(force / contact.length, along, length);
    } else {
        const double side = force < 0.0 ? -1.0 : 1.0;
        const double friction = joint.weakens ? joint.tan_friction_residual : joint.tan_friction;
        const double opening = std::abs(contact.slip_sum) < joint.dilation_cutoff_slip ? joint.tan_dilation : 0.0;
        const double lift = side * contact.slip_sum > 0.0 ? -opening : opening;  // per slip
        const double stiffening = std::max(friction * joint.kn * contact.length * lift, -0.9 * ks);
        Vector6 strength = friction * normal;
        if (joint.weakens && contact.face >= 0) strength += joint.cohesion_residual * length;
        const Vector6 slip = (strength - side * ks * along) / (ks + stiffening);  // grows by this times a displacement
        sum.add(side, along, strength - stiffening * slip);
        sum.add(-joint.kn * contact.length * lift, across, slip);
    }
    sum.turn_along(at, reaction.force);
    const Matrix6& k = tangent.stiffness;
    tangent.symmetric = (k - k.transpose()).norm() < negligible * k.norm();
    return tangent;
}

}  // namespace talus
