// Which blocks a step has to look at, when others are frozen because they are at rest.
#pragma once

#include "core/types.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace talus {

struct BlockRange {  // [begin, end), at most `blocks_per_range` of them, all of one such row of numbers
    BlockId begin, end;
};
inline constexpr int blocks_per_range = 256;  // fixed, so that sums do not depend on the number of threads

/// In ranges of consecutive numbers: where nothing is frozen, loops over them are what they would be over all blocks.
struct Awake {
    std::vector<BlockRange> moving;   // not frozen
    std::vector<BlockRange> loaded;   // those, and frozen ones that meet them or carry a load of the scene
    std::vector<BlockRange> resting;  // all others
};

Awake all_awake(int blocks);

enum class Rest : std::uint8_t { moving, loaded, resting };  // loaded: at rest, but its load may change

/// [nb]
Awake awake(std::span<const Rest> blocks);

}  // namespace talus
