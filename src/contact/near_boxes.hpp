// Compares one box with many in vector registers.
#pragma once

#include "contact/vector_unit.hpp"
#include "core/types.hpp"

namespace talus {

/// Boxes with their bounds rounded and apart, as the registers want them. Rounding keeps order (x <= y gives float(x) <=
/// float(y)), so boxes that overlap do so after rounding as well; those found are to be asked again, exactly.
struct RoundedBoxes {
    std::vector<float> xmin, ymin, xmax, ymax;  // [number of boxes] m

    void resize(std::size_t boxes);
    void set(std::size_t place, const Box& box);
};

/// Writes which of the boxes at the places [from, to) may overlap the one at `place`, in order, and returns how many these
/// are; `near` has room for to - from and 16 more. Bounds that are not numbers overlap nothing.
using FindNear = int (*)(const RoundedBoxes& boxes, int place, int from, int to, int* near);

/// For few boxes of which some are near.
FindNear near_kernel(VectorUnit unit);

/// For many boxes of which very few are near.
FindNear rarely_near_kernel(VectorUnit unit);

/// Along y only: bounds along x are not looked at.
FindNear near_along_y_kernel(VectorUnit unit);

}  // namespace talus
