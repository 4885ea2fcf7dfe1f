// Outlines as the author gives them: what is wrong with them, and shapes that stand for one.
#pragma once

#include "core/types.hpp"
#include "scenario/cursor.hpp"

#include <string>

namespace talus {

/// What keeps the corners from being a simple polygon with an area; empty if nothing does. Coordinates in the message are
/// `origin` + corner.
std::string outline_problem(const Polygon& corners, const Vec2& origin);

double outline_area(const Polygon& corners);  // m2, positive when counter-clockwise

/// Regular polygon with corners on the circle, the first one at +x.
Polygon circle_outline(const Vec2& center, double radius, int sides);

/// Counter-clockwise, without the repeated last corner. Empty after a fault.
Polygon as_outline(Polygon corners, const Cursor& at);
Polygon read_outline_at(const Cursor& at);  // corners
Polygon read_region_at(const Cursor& at);   // corners, or {circle: ...}
Polygon read_circle_at(const Cursor& at);   // center, radius, sides

}  // namespace talus
