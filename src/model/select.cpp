#include "model/select.hpp"

#include "core/text.hpp"
#include "geometry/polygon.hpp"
#include "model/build.hpp"

#include <algorithm>

namespace talus {
namespace {

// Points on an edge belong to the block although rounding may put them outside; far below any gap that matters.
constexpr double on_edge = 1e-9;  // m

std::vector<BlockId> matching(const Model& model, const Selector& selector) {
    if (!selector.block.empty()) return blocks_named(model, selector.block);
    std::vector<BlockId> found;
    const int region = index_of(model.region_names, selector.region);
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        const Vec2& start = model.blocks.start[b];
        const bool meant = !selector.region.empty() ? region >= 0 && model.blocks.region[b] == region
                           : selector.at            ? contains(model, b, *selector.at - start, on_edge)
                                                    : contains(selector.inside, start);
        if (!meant) continue;
        found.push_back(b);
        if (selector.at) break;  // one block, even where several meet
    }
    return found;
}

std::string text(const Selector& selector, const Vec2& origin) {
    if (!selector.block.empty()) return "no block is named `" + selector.block + "`";
    if (!selector.region.empty()) return "no block lies in the region `" + selector.region + "`";
    if (selector.at) return "no block contains the point " + place(*selector.at + origin);
    return "no block has its centroid inside the given outline";
}

}  // namespace

int index_of(const std::vector<std::string>& names, const std::string& name) {
    const auto at = std::find(names.begin(), names.end(), name);
    return at == names.end() ? -1 : static_cast<int>(at - names.begin());
}

std::vector<BlockId> blocks_named(const Model& model, const std::string& name) {
    const auto where = [&](auto meant) {
        std::vector<BlockId> found;
        for (BlockId b = 0; b < model.blocks.size(); ++b)
            if (meant(b)) found.push_back(b);
        return found;
    };
    const std::vector<std::string>& names = model.blocks.name;
    auto found = where([&](BlockId b) { return names[b] == name; });
    if (found.empty()) found = where([&](BlockId b) { return names[b].starts_with(name + "["); });
    const int region = index_of(model.region_names, name);
    if (found.empty() && region >= 0) found = where([&](BlockId b) { return model.blocks.region[b] == region; });
    return found;
}

bool contains(const Model& model, BlockId block, const Vec2& arm, double tolerance) {
    const Corners& corners = model.corners;
    for (PartId p = model.blocks.first_part[block]; p < model.blocks.first_part[block + 1]; ++p) {
        bool inside = true;
        for (int k = model.parts.first_corner[p]; inside && k < model.parts.first_corner[p + 1]; ++k)
            inside = corners.normal[k].dot(arm) <= corners.offset[k] + tolerance;
        if (inside) return true;
    }
    return false;
}

std::vector<BlockId> select(const Model& model, const State& state, const Selector& selector) {
    std::vector<BlockId> found = matching(model, selector);
    std::erase_if(found, [&](BlockId b) { return state.removed[b] != 0; });
    if (found.empty()) throw InputError({Fault{selector.where, selector.key, text(selector, model.origin)}});
    return found;
}

}  // namespace talus
