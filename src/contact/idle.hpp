// Pairs that do nothing to each other: the quick test that they still do not.
#pragma once

#include "contact/contacts.hpp"
#include "contact/separation.hpp"

#include <algorithm>
#include <cmath>

namespace talus {

/// What keeps a and b apart. `reach`: how far, per axis, any point of either block can move from where it is now until the
/// list is made anew, m. `never`: not even then can they touch.
struct Apart {
    Idle idle;
    bool never = false;
};
Apart keep_apart(const Model& model, const Placed& placed, PartId a, PartId b, const Separation& separation, double reach);

/// True if neither block has moved far enough since the last test for the pair to touch.
inline bool not_yet(const Placed& placed, const Idle& idle) {
    return idle.until > 0.0 && placed.path[idle.block_of_edge] + placed.path[idle.block_of_corner] < idle.until;
}

/// True if the pair is certainly apart; false if it must be looked at. Same arithmetic as separation_by_edge. Also says how
/// far the blocks may go before that has to be asked again.
inline bool still_apart(const Model& model, const Placed& placed, Idle& idle) {
    const Vec2 &from = placed.block[idle.block_of_edge].position, &to = placed.block[idle.block_of_corner].position;
    const Vec2& n = placed.corner[idle.edge].normal;
    const Vec2 &arm = placed.corner[idle.corner].arm, &other_arm = placed.corner[idle.other_corner].arm;
    const double dx = to.x() - from.x(), dy = to.y() - from.y();
    const double nearest = std::min(n.x() * arm.x() + n.y() * arm.y(), n.x() * other_arm.x() + n.y() * other_arm.y());
    const double distance = nearest + (n.x() * dx + n.y() * dy) - model.corners.offset[idle.edge];
    if (!(distance >= -idle.touch_depth)) return false;

    // Where a corner lies farther from the centroid of the other block than that block reaches, turning moves the line of
    // the edge there by more than any point of the block.
    const Vec2 d(dx, dy);
    const double gap = distance + idle.touch_depth, radius = model.blocks.radius[idle.block_of_edge];
    const double far = std::sqrt(std::max((arm + d).squaredNorm(), (other_arm + d).squaredNorm())) + gap;
    const double rounding = 1e-14 * (far + radius + std::abs(dx) + std::abs(dy));  // some ten times that of `distance`
    const double paths = placed.path[idle.block_of_edge] + placed.path[idle.block_of_corner];
    idle.until = (paths + (gap - rounding) * radius / std::max(radius, far)) * (1.0 - 1e-15);
    return true;
}

}  // namespace talus
