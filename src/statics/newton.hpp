// Newton's method on the out-of-balance forces: the last digits of an equilibrium that relaxation has come close to.
#pragma once

#include "model/placed.hpp"
#include "statics/relaxation.hpp"

#include <memory>

namespace talus {

class Newton {
public:
    Newton();
    ~Newton();

    /// One iteration: (K + shift M') dx = F with the tangents of all contacts and the turning of loads, factorised sparsely
    /// (LDL^T while all contacts stick, LU where some slide), then the longest of dx, dx/2, ..., dx/64 that brings the
    /// unbalanced energy down. Each of them is one step of the law from where the contacts are now; what is tried in vain
    /// leaves no trace. True if one helped; otherwise all is as it was. The shift falls tenfold with every success, and
    /// rises when there was none.
    bool improve(const Model& model, const ScaledMass& mass, const Placed& placed, double longest, const Forces& forces,
                 State& state);

    /// Whether this equilibrium is one that nothing stays in, as a block on its tip: there is a displacement along which the
    /// stiffness is negative although all contacts stick (a negative pivot of LDL^T), and the forces of a small step along
    /// it, either way, lead away. `way`: that step, as rates, back to where the stage began; a tenth of an overlap long.
    bool unstable(const Model& model, const ScaledMass& mass, const Placed& placed, const Forces& forces, State& state,
                  Motion& way);

private:
    struct System;
    std::unique_ptr<System> system_;  // with the pattern of the factors, kept while the same blocks touch
};

/// Moves all blocks by a share of these rates, which become theirs: the law of contacts then takes one step.
void move(double share, const Motion& way, Motion& motion);

}  // namespace talus
