// What joints will have to carry, as far as it can be known before anything moves; and how far they give under it.
#pragma once

#include "model/model.hpp"
#include "model/state.hpp"
#include "scenario/scenario.hpp"

#include <algorithm>
#include <span>

namespace talus {

struct Burden {
    double stress = 0.0;         // Pa, on the lowest joint: weight above, loads, initial stress
    double speed = 0.0;          // m/s, at which blocks that fly hit others; 0 if none flies
    double density = 0.0;        // kg/m3, mean
    double mean_size = 1.0;      // m, square root of the mean area of a block
    double smallest_size = 1.0;  // m, of a block that is not held
    double gravity = 0.0;        // m/s2, largest
    double layers = 1.0;         // blocks of mean size above each other

    /// Share of the size of a mean block by which a joint of this normal stiffness (Pa/m) closes: a face under the stress,
    /// or a corner that hits, which stops at the depth d where kn d^3/3 is its kinetic energy.
    double closure(double normal_stiffness) const;
    /// Pa/m, at which a joint closes by this share.
    double stiffness(double closure) const;
    /// How far the top comes down when the stress grows evenly with depth, as the same share.
    double settlement(double normal_stiffness) const { return closure(normal_stiffness) * std::max(1.0, 0.5 * layers); }
};

/// `state`: at the very start.
Burden burden_of(const Scenario& scenario, const Model& model, const State& state);

/// s, the longest step within `share` of the time in which weight brings the smallest free block, or a load its own block,
/// through its size (square root of its area). Tables count with their mean over a step: a blow that is shorter gives a
/// speed, and no more.
double step_of_fall(const Model& model, std::span<const Load> loads, double share);

/// Whether some block can fly: it stands on nothing that stands, and falls or is thrown; or is thrown among others.
bool blocks_fly(const Model& model, const State& state);

}  // namespace talus
