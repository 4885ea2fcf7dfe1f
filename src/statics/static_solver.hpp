// Equilibrium without time: what is out of balance when a stage begins comes on little by little, blocks are relaxed, and
// Newton's method finds the last digits.
//
// Friction depends on the path, and the path that counts is that of the loads. So they come on no faster than the blocks
// follow (`path_ratio`), with a damping that is critical for the whole, and contacts live through one step of their law with
// every iteration, as they do in motion.
#pragma once

#include "statics/newton.hpp"
#include "statics/relaxation.hpp"

namespace talus {

/// The load grows while less than this is out of balance, as a share of what it adds to the mean contact force, or of the
/// largest force that comes with it: not of contact forces that were there before. A wedge squeezed by rock may carry ten
/// times its weight in contact forces and hold by a tenth of it.
inline constexpr double path_ratio = 0.1;
/// Newton's method needs the contacts to be mostly those of the end.
inline constexpr double polish_ratio = 1e-3;
/// What still moves, in sizes of its block per characteristic time, in equilibrium.
inline constexpr double largest_drift = 1e-6;

class StaticSolver {
public:
    StaticSolver(const Model& model, State& state);  // of a stage that begins or goes on

    /// Takes what is out of balance now as the load that is to come, unless it is below the `tolerance` of the unbalanced
    /// ratio; all blocks are at rest.
    void begin(const Model& model, double tolerance, State& state);

    /// One iteration of the relaxation or of Newton's method. Sets reached or moving in State::statics.now when there is an
    /// answer; the unbalanced ratio must be below `tolerance`.
    void iterate(const Model& model, const Placed& placed, double tolerance, const Forces& forces, State& state);

private:
    void bring_on_load(State& state) const;
    bool polish(const Model& model, const Placed& placed, double tolerance, const Forces& forces, State& state);
    void settle(const Model& model, const Placed& placed, const Forces& forces, State& state);
    void look(const Model& model, double tolerance, State& state) const;
    void look_for_fall(const Model& model, State& state) const;
    void look_for_motion(const Model& model, State& state) const;
    double way_ahead(BlockId b, const State& state) const;

    ScaledMass mass_;
    Newton newton_;
    double longest_;  // m, that anything moves in one iteration
};

/// load -= what is held back of it.
void hold_back(const Statics& statics, std::vector<Force>& load);

}  // namespace talus
