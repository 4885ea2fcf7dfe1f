#include "model/awake.hpp"

namespace talus {
namespace {

void append(BlockId b, std::vector<BlockRange>& ranges) {
    if (ranges.empty() || ranges.back().end != b || b % blocks_per_range == 0)
        ranges.push_back({b, b + 1});
    else
        ++ranges.back().end;
}

}  // namespace

Awake all_awake(int blocks) {
    Awake all;
    for (BlockId b = 0; b < blocks; ++b) append(b, all.moving);
    all.loaded = all.moving;
    return all;
}

Awake awake(std::span<const Rest> blocks) {
    Awake found;
    for (BlockId b = 0; b < static_cast<BlockId>(blocks.size()); ++b) {
        if (blocks[b] == Rest::moving) append(b, found.moving);
        append(b, blocks[b] == Rest::resting ? found.resting : found.loaded);
    }
    return found;
}

}  // namespace talus
