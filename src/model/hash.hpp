// A number that tells two states apart: equal for every search, skin, number of threads and restart.
#pragma once

#include "model/model.hpp"
#include "model/state.hpp"

#include <cstdint>

namespace talus {

/// FNV-1a over the bits of time, step, motion, the memory of contacts that are alive, and broken bonds. -0 counts as 0.
std::uint64_t state_hash(const Model& model, const State& state);

}  // namespace talus
