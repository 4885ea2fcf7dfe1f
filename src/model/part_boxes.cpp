#include "model/part_boxes.hpp"

namespace talus {

void part_boxes(const Model& model, const State& state, const Placed& placed, std::vector<Box>& boxes) {
    const int np = model.parts.size();
    boxes.resize(np);
    for (PartId p = 0; p < np; ++p) {
        const BlockId block = model.parts.block[p];
        boxes[p] = {1.0, 1.0, -1.0, -1.0};  // absent
        if (state.removed[block]) continue;
        const Vec2& at = state.motion.position[block];
        Vec2 low = placed.corner[model.parts.first_corner[p]].arm, high = low;
        for (int k = model.parts.first_corner[p] + 1; k < model.parts.first_corner[p + 1]; ++k) {
            low = low.cwiseMin(placed.corner[k].arm);
            high = high.cwiseMax(placed.corner[k].arm);
        }
        boxes[p] = {low.x() + at.x(), low.y() + at.y(), high.x() + at.x(), high.y() + at.y()};
    }
}

}  // namespace talus
