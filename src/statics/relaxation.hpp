// Viscous dynamic relaxation with the damping of the slowest motion that is left, found on the way.
#pragma once

#include "statics/scaled_mass.hpp"

#include <functional>

namespace talus {

/// The forces of a static stage, as a solver sees them.
struct Forces {
    std::function<void()> evaluate;  // moves contacts and loads on to where the blocks are now, by Motion::velocity
    std::function<void()> put_back;  // after contacts, motion and loads of before were put back: scratch follows
};

/// m, the largest displacement of any corner for these rates; infinite if one is not a number.
double largest_rate(const Model& model, const Motion& motion);

/// Iterations after which the damping is measured anew. Shorter ones see mostly the trembling of single blocks and damp the
/// whole far too much (2400 iterations for 1,000 blocks with 1, 830 with 5, 650 with 25), longer ones lag behind.
inline constexpr int damping_window = 25;

/// One iteration: rates and places move on by a step of 1, and forces are evaluated once,
///     v = ((2 - c) v + 2 M'^-1 F) / (2 + c),   x += v.
/// The damping is c = 2 w0, critical for the slowest mode, with the Rayleigh quotient over the last window
/// w0^2 = -(dx . dF) / (dx . M' dx) [underwood1983]: 0 where something moves that nothing holds. Nothing moves by more than
/// `longest` (m) at once.
void relax(const Model& model, ScaledMass& mass, double longest, const Forces& forces, State& state);

/// Starts from rest.
void start_relaxation(ScaledMass& mass, State& state);

}  // namespace talus
