// How a block goes, and how the mass of all that move: slide, topple, both, fall, rotation. Docs: method.md, Verdict.
#pragma once

#include "model/model.hpp"
#include "model/state.hpp"
#include "verdict/footing.hpp"

#include <vector>

namespace talus {

// Of the way, for the slip. A toe that holds does not slip at all; one that lacks 0.3 degrees of friction slips by 0.03 of
// the way on steep slopes, by 0.07 on gentle ones. Twice of it would not see that.
inline constexpr double a_slip = 0.02;
// Times what springs account for: no motion at all. Half of it would take a toe that gives for one that slips.
inline constexpr double no_motion = 4.0;

/// Whether the mass with which the block goes slips on what carries it.
bool slips(const Model& model, const State& state, const Footing& footing, BlockId b);

/// Whether nothing has carried the block since the window of the course began: all that acted on it is its weight, loads on
/// it and local damping. Without gravity: nothing touches it.
bool fell_freely(const Model& model, const State& state, const Footing& footing, BlockId b);

/// From how its base set out, how far that has turned since, and whether the block fell in the last window.
Mechanism mechanism_of(const Model& model, const State& state, const Footing& footing, BlockId b);

/// The same from how it stands now alone, for a state without a course.
Mechanism mechanism_seen_now(const Model& model, const State& state, const Footing& footing, BlockId b);

/// Of all that move: what most of the area does. `block_mechanism` [nb]; blocks of a mass that slips round as one become
/// its rotation.
Mechanism mechanism_of_the_mass(const Model& model, const State& state, std::vector<Mechanism>& block_mechanism);

}  // namespace talus
