#include "model/title.hpp"

#include "core/text.hpp"

#include <cmath>

namespace talus {

std::string title(const Model& model, BlockId b) {
    const std::string& name = model.blocks.name[b];
    return "block " + std::to_string(b) + (name.empty() ? "" : " `" + name + "`");
}

std::string title_and_place(const Model& model, BlockId b) {
    return title(model, b) + " at " + place(model.blocks.start[b] + model.origin, std::sqrt(model.blocks.area[b]));
}

}  // namespace talus
