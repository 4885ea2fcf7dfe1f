// Looks through ends that were in order for those that are so no more, in vector registers.
#pragma once

#include "contact/vector_unit.hpp"

#include <cstddef>

namespace talus {

/// Compares each of the ends at the places [from, to) with the one before it, `from` > 0, and writes the places of those
/// that are not above it, equal coordinates and those that are not numbers included. Returns how many these are; `places`
/// has room for to - from and 8 more. An end of tag t has the coordinate coordinate[2 t].
using FindDisorder = int (*)(const double* coordinate, const int* tag, int from, int to, int* places);
FindDisorder disorder_kernel(VectorUnit unit);

}  // namespace talus
