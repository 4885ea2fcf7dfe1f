// Plain contacts of faces (no intact bonds), many at a time. Most contacts of a rock mass are of this kind, and all of them
// go this way, so that a result does not depend on how they were grouped.
#pragma once

#include "contact/contact_batch.hpp"
#include "contact/face_window.hpp"

namespace talus {

/// Names as in FaceLines and InitialClosure.
struct FaceBatch : ContactBatch {
    Row a0x, a0y, a1x, a1y, nax, nay, b0x, b0y, b1x, b1y, nbx, nby;
    Row a_lo, a_hi, b_lo, b_hi;
    Row remembers, s0, s1, sigma0, sigma1;  // sigma in Pa
};

/// All contacts of the batch over a step dt (0: forces only). `damping`: stiffness-proportional, s. The same bits with every
/// unit.
using FaceKernel = void (*)(FaceBatch& batch, double dt, double damping);
FaceKernel face_kernel(VectorUnit unit);

}  // namespace talus
