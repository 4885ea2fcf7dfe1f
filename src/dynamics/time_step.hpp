// How large a step may be: a rigorous bound, an estimate of the true limit, and a guard against passing through things.
#pragma once

#include "model/model.hpp"
#include "model/placed.hpp"
#include "model/state.hpp"

#include <cstdint>
#include <vector>

namespace talus {

struct StableStep {
    double bound = 0.0;     // s, never above the true limit of the linear system
    double estimate = 0.0;  // s, of the true limit, from power iterations on the contacts there are
    BlockId block = -1;     // that governs the bound
    double thinnest = 0.0;  // m, smallest width of any part that takes part in motion
};

/// Bound: two blocks joined by a spring store k |d_i - d_j|^2 / 2 <= k (|d_i|^2 + |d_j|^2), so the stiffness matrix is below
/// twice its block diagonal and omega_max^2 <= 2 max_i lambda_max(M_i^-1 K_ii). K_ii is that of block i with its whole
/// boundary pressed against fixed neighbours: it depends on the model alone, neither on the contact list nor on the state.
/// Estimate: largest Rayleigh quotient found by power iteration on the contacts that carry force, and of each free block
/// alone on its longest face. Both are shortened for contact damping: 2/omega (sqrt(1 + xi^2) - xi), xi = beta omega / 2.
StableStep stable_step(const Model& model, const Placed& placed, const State& state);

/// [nb] s, that bound for each block: the least of them is that of all. Infinite for blocks that are held or removed.
std::vector<double> block_limits(const Model& model, const Placed& placed, const State& state);

/// m, smallest width of a part, with those of blocks that take substeps as many times wider: what a step may not pass over.
double narrowest(const Model& model, const State& state);

/// [nb] K_ii of that bound, about the centroid, with x, y and the angle as the corners are placed now: the stiffness of a
/// block whose whole boundary is pressed against neighbours at rest. Zero for blocks that are held or removed.
std::vector<Eigen::Matrix3d> boundary_stiffness(const Model& model, const Placed& placed,
                                                const std::vector<std::uint8_t>& removed);

/// 2/omega for contact damping beta (s).
double damped_limit(double omega, double beta);

inline constexpr int most_halvings = 40;

/// How often the step must be halved so that nothing moves further than a quarter of the thinnest part in one step; with
/// hysteresis, so that it does not change to and fro. Throws DivergenceError beyond most_halvings.
int step_halvings(double stage_step, int halvings_now, double speed, double thinnest);

/// m/s, of the fastest point that loads and driving alone bring about within a step of dt from stage_time on, where tables
/// are straight lines.
double speed_ahead(const Model& model, double stage_time, double dt);

/// s, ascending: when tables of weight, loads and driven velocities turn so sharply that a step of dt across it, which
/// knows them at its ends alone, would miss a hundredth of their largest value: pulses, and jumps. Steps have to end there.
std::vector<double> sharp_turns(const Model& model, double dt);

}  // namespace talus
