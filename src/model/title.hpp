// How messages name a block.
#pragma once

#include "model/model.hpp"

#include <string>

namespace talus {

std::string title(const Model& model, BlockId b);            // "block 3 `name`"
std::string title_and_place(const Model& model, BlockId b);  // "block 3 `name` at (x, y)", where it was at the start

}  // namespace talus
