// Stress before anything moves: what the joint faces carry at the start, and what the free sides of the rock need to be in
// balance with it.
#pragma once

#include "geometry/polygon.hpp"
#include "model/model.hpp"
#include "model/neighbours.hpp"
#include "model/state.hpp"
#include "scenario/scenario.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace talus {

/// Stress tensor S that varies linearly with place; compression positive. The traction of part a on part b across a face
/// with unit normal n from a to b is S n (Cauchy): n . S n presses, perp(n) . S n shears.
struct StressField {
    Eigen::Matrix2d at_reference = Eigen::Matrix2d::Zero();                            // Pa
    Eigen::Matrix2d per_x = Eigen::Matrix2d::Zero(), per_y = Eigen::Matrix2d::Zero();  // Pa/m
    Vec2 reference = Vec2::Zero();                                                     // m

    Eigen::Matrix2d operator()(const Vec2& at) const {
        return at_reference + (at.x() - reference.x()) * per_x + (at.y() - reference.y()) * per_y;
    }
};

/// The field a scenario asks for. rock_weight: N/m3, density of the rock x |gravity|; top: m, highest point of the rock.
StressField stress_field(const InitialStressSpec& spec, double rock_weight, double top);

struct Prestress {
    std::vector<JointFace> faces;     // bonded or under stress, sorted by parts, cells numbered
    std::vector<double> shear_force;  // [faces] N, on b along perp(normal a->b)
    int beyond_strength = 0;          // faces whose shear or tension is more than their joint can carry
    int tension_dropped = 0;          // faces whose joint cannot pull: tension was set to zero
};

/// The joint faces of a scene: one per touching pair whose joint can be bonded or that carries stress, none between two
/// blocks that never move. joint[i]: joint of touch i; spec may be null: no initial stress.
Prestress make_faces(const Model& model, const std::vector<Neighbours::Touch>& touches, std::span<const int> joint,
                     std::span<const Vec2> corner, const InitialStressSpec* spec, const StressField& field);

/// The contacts of a scene at rest: one per joint face, with the stress it carries. shear_force[i]: N, of face i.
std::vector<Contact> first_contacts(const Model& model, std::span<const double> shear_force);

/// Dead loads that carry the field on the sides named by `spec`, where no other block touches: one per block, constant.
std::vector<Load> boundary_loads(const Model& model, const InitialStressSpec& spec, const StressField& field,
                                 std::span<const Vec2> corner, std::span<const std::uint8_t> covered, int blocks,
                                 const Box& outline);

}  // namespace talus
