// Pairs that do nothing to each other: the quick test that they still do not.
#pragma once

#include "contact/contacts.hpp"
#include "contact/separation.hpp"

#include <algorithm>

namespace talus {

/// What keeps a and b apart. `reach`: how far, per axis, any point of either block can move from where it is now until the
/// list is made anew, m. `never`: not even then can they touch.
struct Apart {
    Idle idle;
    bool never = false;
};
Apart keep_apart(const Model& model, const Placed& placed, PartId a, PartId b, const Separation& separation, double reach);

/// True if the pair is certainly apart; false if it must be looked at. Same arithmetic as separation_by_edge.
inline bool still_apart(const Model& model, const Placed& placed, const Idle& idle) {
    const Vec2 &from = placed.block[idle.block_of_edge].position, &to = placed.block[idle.block_of_corner].position;
    const Vec2& n = placed.corner[idle.edge].normal;
    const Vec2 &arm = placed.corner[idle.corner].arm, &other_arm = placed.corner[idle.other_corner].arm;
    const double dx = to.x() - from.x(), dy = to.y() - from.y();
    const double nearest = std::min(n.x() * arm.x() + n.y() * arm.y(), n.x() * other_arm.x() + n.y() * other_arm.y());
    return nearest + (n.x() * dx + n.y() * dy) - model.corners.offset[idle.edge] >= -idle.touch_depth;
}

}  // namespace talus
