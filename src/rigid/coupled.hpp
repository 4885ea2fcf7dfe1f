// One contact whose normal impulse and friction act on each other so much that neither can be found after the other.
#pragma once

#include "rigid/impulses.hpp"

namespace talus::rigid {

/// Whether friction at its bound may change the normal velocity by nearly as much as the normal impulse that bounds it: a
/// sweep that takes one after the other turns in a circle there, or runs away [painleve1895].
bool coupled(const Touch& touch, std::span<const Softness> bodies);

/// Normal impulses and friction of such a contact at once: of separating, sticking and sliding either way, with either end
/// or both, the first that fulfils all conditions. `q`: m/s, along the normal at both ends and along perp(normal), above
/// what is asked for, without any impulse. Writes p and slips; false if nothing does.
bool solve_together(Touch& touch, std::span<const Softness> bodies, const double q[3]);

}  // namespace talus::rigid
