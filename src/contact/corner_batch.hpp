// Pairs of corners that have gone into each other, many at a time: most contacts of a rock mass that are no faces.
#pragma once

#include "contact/contact_batch.hpp"
#include "contact/corner_pair.hpp"

namespace talus {

/// Names as in CornerLines.
struct CornerBatch : ContactBatch, ContactColumns {
    static constexpr int size = ContactColumns::size;
    using Row = ContactColumns::Row;
    Row ax, ay, na1x, na1y, na2x, na2y, bx, by, nb1x, nb1y, nb2x, nb2y, reach, touch_depth;
};

/// All contacts of the batch over a step dt (0: forces only). `damping`: stiffness-proportional, s. Loaded are those that
/// are valid. The same bits with every unit, and as corner_pair() by itself.
using CornerKernel = void (*)(CornerBatch& batch, double dt, double damping);
CornerKernel corner_kernel(VectorUnit unit);

}  // namespace talus
