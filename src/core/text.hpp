// Numbers as they stand in messages.
#pragma once

#include "core/types.hpp"

#include <string>

namespace talus {

std::string number(double x);       // 6 digits, without trailing zeros
std::string map_number(double x);   // 10 digits, a coordinate
std::string place(const Vec2& at);  // "(x, y)" with 10 digits, enough for a millimetre on a map

/// "(x, y)" with as many decimals as it takes to find something of this size (m) there: to a hundredth of it.
std::string place(const Vec2& at, double size);

}  // namespace talus
