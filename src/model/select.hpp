// Blocks by name and by place.
#pragma once

#include "model/model.hpp"

#include <string>
#include <vector>

namespace talus {

/// Position of a name in a list, -1 if it is not there.
int index_of(const std::vector<std::string>& names, const std::string& name);

/// Blocks of that name, or else the repetitions name[0], name[1], ..., or else the blocks of that region; ascending.
std::vector<BlockId> blocks_named(const Model& model, const std::string& name);

/// True if a point given relative to the centroid of a block, unrotated, m, lies in it or within `tolerance` m of it.
bool contains(const Model& model, BlockId block, const Vec2& arm, double tolerance);

}  // namespace talus
