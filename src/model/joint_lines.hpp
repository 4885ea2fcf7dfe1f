// Joint sets, cracks and trace maps as the lines along which rock is cut.
#pragma once

#include "geometry/cut.hpp"
#include "scenario/scenario.hpp"

#include <vector>

namespace talus {

/// Lines of a joint set inside `box`, all with the given source.
///
/// Line 0 passes through the origin, lines 1, 2, ... follow on the left of the mean direction and -1, -2, ... on its right,
/// each one spacing from the last, measured across the set; each line turns about the point where it meets the normal
/// through the origin. What is drawn for a line depends on the seed, the name of the set and the number of the line alone,
/// so that neither another set nor a larger rock changes it.
/// Angles (normal or uniform) are truncated at 3 deviations, spacings and trace lengths to [mean/5, 5 mean], by drawing
/// again: the mean of a skewed distribution moves a little (exponential: +16 %). With persistence below 1 every piece of
/// trace length l is followed by a gap l (1 - persistence) / persistence, starting at a random phase.
/// Throws InputError if spacing or trace length are not positive, give more than a million pieces, or if the origin is
/// ten million of them away.
std::vector<CutLine> joint_set_lines(const JointSetSpec& set, const Box& box, int source);

/// All lines of the rock. Sources: joint sets are 0, 1, ..., then each crack has one, then the trace map as a whole. Joint
/// lines reach past the box of the outline by 1 % of its diagonal and cracks by 1e-9 of it past their tips, so that no end
/// decides by rounding whether a block is cut; what sticks out is pruned by the cut.
std::vector<CutLine> joint_lines(const RockSpec& rock);

/// Smallest distance by which the ends of given lines are drawn out, m: 1e-9 of the diagonal of the outline.
double tip_reach(const RockSpec& rock);

}  // namespace talus
