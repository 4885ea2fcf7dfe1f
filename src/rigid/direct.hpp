// What sweeps find slowly, found at once: one linear system for all contacts that press.
#pragma once

#include "rigid/impulses.hpp"

#include <Eigen/SparseCholesky>

#include <span>
#include <vector>

namespace talus::rigid {

/// Takes the contacts as they are, pressing or not and sticking or not, and finds the impulses for which all that press
/// meet their velocity exactly: the subspace minimization of [silcowitz2010]. The equations are those of the bodies,
/// (M + J^T W J) dv = -J^T W (J v - u_min), with W a thousand million times the mass that a contact sees; since it is not
/// infinite the solution is repeated with what is left, so that contacts which depend on each other keep what they had.
/// Friction that slips stays as it is. Impulses that would pull are put to zero: sweeps have to go on from there.
class DirectSolver {
public:
    /// To `tolerance` (m/s). False if there is nothing to do, or it failed: what it leaves is of no use then.
    bool solve(std::span<Touch> touches, std::span<const Softness> bodies, std::span<Velocity> velocity, double tolerance);

private:
    struct Row {
        int touch, kind;  // 0, 1: normal at an end, 2: tangent
        double along[6];  // of the velocities of a, then b: x, y, spin
        double weight;    // kg
        double least;     // m/s
    };
    void list_rows(std::span<const Touch> touches, std::span<const Softness> bodies);
    bool factor(std::span<const Touch> touches, std::span<const Softness> bodies);
    double missing(std::span<const Touch> touches, std::span<const Velocity> velocity);  // m/s, largest
    void push(std::span<Touch> touches, std::span<const Softness> bodies, std::span<Velocity> velocity);

    std::vector<Row> rows_;
    std::vector<double> missing_;  // [rows] m/s
    std::vector<int> unknown_;     // [bodies] first of three, -1 = does not give way
    int unknowns_ = 0;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> matrix_;
};

}  // namespace talus::rigid
