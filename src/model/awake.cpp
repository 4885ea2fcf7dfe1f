#include "model/awake.hpp"

#include <algorithm>
#include <cstdint>

namespace talus {
namespace {

template <class Belongs>
std::vector<BlockRange> ranges(int blocks, Belongs&& belongs) {
    std::vector<BlockRange> found;
    for (BlockId b = 0; b < blocks; ++b) {
        if (!belongs(b)) continue;
        if (found.empty() || found.back().end != b || b % blocks_per_range == 0)
            found.push_back({b, b + 1});
        else
            ++found.back().end;
    }
    return found;
}

}  // namespace

Awake all_awake(int blocks) {
    const std::vector<BlockRange> all = ranges(blocks, [](BlockId) { return true; });
    return {all, all, {}};
}

Awake awake(const Model& model, const State& state) {
    const int nb = model.blocks.size();
    std::vector<std::uint8_t> loaded(nb);
    for (BlockId b = 0; b < nb; ++b) loaded[b] = !state.frozen(b);
    for (const Load& load : model.loads) loaded[load.block] = 1;
    for (const Contact& c : state.contacts.list) {
        const BlockId a = model.parts.block[c.part_a], b = model.parts.block[c.part_b];
        if (state.frozen(a) != state.frozen(b)) loaded[a] = loaded[b] = 1;
    }
    return {ranges(nb, [&](BlockId b) { return !state.frozen(b); }), ranges(nb, [&](BlockId b) { return loaded[b] != 0; }),
            ranges(nb, [&](BlockId b) { return loaded[b] == 0; })};
}

}  // namespace talus
