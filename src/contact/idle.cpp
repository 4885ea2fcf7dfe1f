#include "contact/idle.hpp"

#include <cmath>
#include <numbers>

namespace talus {

Apart keep_apart(const Model& model, const Placed& placed, PartId a, PartId b, const Separation& separation, double reach) {
    const PartId by = separation.of_a ? a : b, other = separation.of_a ? b : a;
    const BlockId block_by = model.parts.block[by], block_other = model.parts.block[other];
    const int edge = model.parts.first_corner[by] + separation.edge;
    const Vec2 n = placed.corner[edge].normal;
    const Vec2 d = placed.block[block_other].position - placed.block[block_by].position;
    // A corner can come nearer to the line by what both blocks move, and by what the line turns about its own block.
    const double both = 2.0 * std::numbers::sqrt2 * reach, turn = reach / model.blocks.radius[block_by];

    Idle idle{.edge = edge, .block_of_edge = block_by, .block_of_corner = block_other};
    idle.touch_depth = touch_depth(model, a, b);
    int within_reach = 0;
    for (int k = model.parts.first_corner[other]; k < model.parts.first_corner[other + 1]; ++k) {
        const Vec2 from_edge_block = placed.corner[k].arm + d;
        const double distance = n.dot(from_edge_block) - model.corners.offset[edge];
        if (distance > both + turn * (from_edge_block.norm() + both)) continue;
        (++within_reach == 1 ? idle.corner : idle.other_corner) = k;
    }
    if (within_reach == 1) idle.other_corner = idle.corner;
    if (within_reach > 2) idle.corner = idle.other_corner = -1;
    return {idle, within_reach == 0};
}

}  // namespace talus
