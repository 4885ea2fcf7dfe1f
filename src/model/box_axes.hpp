// Along which axes the boxes of parts are taken.
#pragma once

#include "model/model.hpp"

namespace talus {

/// Unit, the first of the two axes of boxes; the second is perpendicular. Along x, unless edges lie within 3 degrees of x or
/// y and less of them along an axis turned a little. Joints along an axis give the boxes of whole rows of blocks equal ends,
/// which change places at every tremor: 2.4 exchanges per block and step in a searched rock mass at 0 degrees, 0.02 at 1.
Vec2 box_axis(const Corners& corners);

}  // namespace talus
