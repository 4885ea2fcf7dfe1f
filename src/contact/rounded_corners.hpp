// The classical contact geometry of the distinct element method, for comparison: rounded corners that touch at points.
#pragma once

#include "contact/placed_part.hpp"
#include "contact/pressed.hpp"

namespace talus {

/// Normal contact of the convex parts A and B as in [cundall1980] and [cundallhart1992]: every corner is an arc that leaves
/// its two edges at Corners::cut from the tip, and presses as a point spring
///     F = kn L u n
/// on an edge (n is that of the edge) or on an arc of the other part (n along the line of both centres). u is the overlap
/// of the rounded shapes. L is half of the length over which the two parts face each other, so that both springs of a face
/// make kn times its length, and never less than the rounding length. Divided by kn; the centroid of b lies at (dx, dy) from
/// that of a.
///
/// What follows from it: a face resists rotation with kn L^3/4, three times what a joint does; n is continuous, but L
/// changes as blocks slide and turn, so the force is no derivative of an energy; a block that tilts turns about a point
/// inside its corner.
Pressed rounded_contact(const Model& model, const PlacedPart& a, const PlacedPart& b, double dx, double dy);

/// E / kn, m3: sum of L u^2 / 2.
double rounded_energy(const Model& model, const PlacedPart& a, const PlacedPart& b, double dx, double dy);

}  // namespace talus
