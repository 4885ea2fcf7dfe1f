// Plain contacts of faces (no intact bonds), many at a time. Most contacts of a rock mass are of this kind, and all of them
// go this way, so that a result does not depend on how they were grouped.
#pragma once

#include "contact/contact_batch.hpp"
#include "contact/face_window.hpp"

namespace talus {

/// Names as in FaceLines.
struct FaceBatch : ContactBatch {
    Row a0x, a0y, a1x, a1y, nax, nay, b0x, b0y, b1x, b1y, nbx, nby;
    Row a_lo, a_hi, b_lo, b_hi;
};

/// All contacts of the batch over a step dt (0: forces only). `damping`: stiffness-proportional, s. What they know is taken
/// from `columns` and put back there, for those that are valid and loaded. The same bits with every unit.
using FaceKernel = void (*)(FaceBatch& batch, FaceColumns& columns, double dt, double damping);
FaceKernel face_kernel(VectorUnit unit);

}  // namespace talus
