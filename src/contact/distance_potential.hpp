// The general contact geometry: distance potential of two convex polygons.
#pragma once

#include "contact/placed_part.hpp"
#include "contact/pressed.hpp"

namespace talus {

/// Normal contact of the convex parts A and B from the potential
///     E = (kn/2) Int_{A and B} (d_A + d_B) dA,      d_P(x) = distance from x to the boundary of P,
/// divided by kn. The centroid of b lies at (dx, dy) from that of a. By the divergence theorem every edge carries the
/// pressure (kn/2) x depth in the other part:
///     F_B = -(kn/2) Sum_{e in dB} n_e Int_{e inside A} d_A ds + (kn/2) Sum_{e in dA} n_e Int_{e inside B} d_B ds .
/// A true potential without corner cases; a face with overlap u gets kn u per metre and its exact moment. Edges between two
/// parts of one block bound the depth of each part, so that no depth is ever measured to a boundary far away; as edges under
/// pressure they are left out, because what they would carry on both their sides cancels exactly.
/// Not loaded (length 0) if the parts do not overlap. The form is Munjiza's (2004) with the distance potential of Liu et al.
/// (2017).
Pressed distance_potential(const PlacedPart& a, const PlacedPart& b, double dx, double dy);

/// Its derivative. Where a loaded stretch ends at depth 0 its end adds nothing, where it ends at a corner it moves along.
void distance_potential_springs(const PlacedPart& a, const PlacedPart& b, double dx, double dy, PressedSprings& found);

/// E / kn of the same, m3. For the energy report only: exact, and slower.
double distance_potential_energy(const PlacedPart& a, const PlacedPart& b, double dx, double dy);

}  // namespace talus
