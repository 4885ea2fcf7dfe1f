#include "model/part_boxes.hpp"

namespace talus {
namespace {

constexpr Box absent{1.0, 1.0, -1.0, -1.0};

Box part_box(const Model& model, const Placed& placed, PartId p, const Vec2& position) {
    const Vec2 at = along(model.box_axis, position);
    Vec2 low = along(model.box_axis, placed.corner[model.parts.first_corner[p]].arm), high = low;
    for (int k = model.parts.first_corner[p] + 1; k < model.parts.first_corner[p + 1]; ++k) {
        const Vec2 arm = along(model.box_axis, placed.corner[k].arm);
        low = low.cwiseMin(arm);
        high = high.cwiseMax(arm);
    }
    return {low.x() + at.x(), low.y() + at.y(), high.x() + at.x(), high.y() + at.y()};
}

}  // namespace

void part_boxes(const Model& model, const State& state, const Placed& placed, std::vector<Box>& boxes) {
    const int np = model.parts.size();
    boxes.resize(np);
#pragma omp parallel for schedule(static)
    for (PartId p = 0; p < np; ++p) {
        const BlockId b = model.parts.block[p];
        boxes[p] = state.removed[b] ? absent : part_box(model, placed, p, state.motion.position[b]);
    }
}

int rebox(const Model& model, const State& state, double skin, Placed& placed, std::vector<Box>& boxes,
          std::vector<std::uint8_t>& reboxed) {
    const int nb = model.blocks.size();
    const bool all = placed.boxed.empty();
    placed.boxed.resize(nb);
    boxes.resize(model.parts.size());
    reboxed.resize(nb);
    int count = 0;
#pragma omp parallel for schedule(static) reduction(+ : count)
    for (BlockId b = 0; b < nb; ++b) {
        const Vec2& at = state.motion.position[b];
        const double angle = state.motion.angle[b];
        reboxed[b] = all || !(placed.boxed[b].moved(at, angle, model.box_axis) <= kept_share * skin);
        if (!reboxed[b]) continue;
        ++count;
        placed.boxed[b] = {at, angle, model.blocks.radius[b]};
        for (PartId p = model.blocks.first_part[b]; p < model.blocks.first_part[b + 1]; ++p)
            boxes[p] = state.removed[b] ? absent : part_box(model, placed, p, at).grown(skin);
    }
    return count;
}

}  // namespace talus
