// What bonds carry within a body, from equilibrium, and which of them break.
#pragma once

#include "rigid/bodies.hpp"

#include <Eigen/SparseCholesky>

#include <memory>
#include <span>
#include <vector>

namespace talus::rigid {

/// The bonded faces of every body as springs between its blocks: with kn and ks of their joints, and no other
/// deformation, the forces follow from equilibrium. A rigid body carries them without moving, so they are needed only to
/// know whether it breaks. The stiffness is that of the body as it was built, so it is factored once for a set of bonds.
class Bonds {
public:
    Bonds(const Model& model, const State& state, const Bodies& bodies);
    bool none() const { return faces_.empty(); }

    /// After the contact list has been renewed, while bodies and bonds are the same.
    void find_slots(const State& state);

    /// Forces for the given out-of-balance `load` [nb] of each block (weight, loads and contacts less mass x acceleration;
    /// N, N m): writes those of the bonded faces into the contact list, breaks what is beyond its strength, and returns how
    /// many faces did.
    int carry(const Model& model, std::span<const Force> load, State& state);

private:
    struct Face {
        int slot;           // in the contact list
        int face;           // in Model::faces
        int a, b;           // unknowns begin at 3 a, 3 b; -1 = does not move
        Vec2 normal;        // at the start, from a to b
        Vec2 arm_a, arm_b;  // m, of the middle of the intact cells from the centroids, at the start
        double kn, ks, kr;  // N/m, N/m, N m
        double length;      // m, of the intact cells
    };
    void factor();
    bool balanced(const Model& model, std::span<const Force> load, const State& state);

    std::vector<Face> faces_;
    std::vector<int> unknown_;      // [nb] of block b, -1 = none
    int unknowns_ = 0;              // blocks that move against a fixed one of their body
    std::vector<Force> left_over_;  // [nb]
    std::unique_ptr<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>> stiffness_;
};

}  // namespace talus::rigid
