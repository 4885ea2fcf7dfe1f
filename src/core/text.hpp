// Numbers as they stand in messages.
#pragma once

#include "core/types.hpp"

#include <string>

namespace talus {

std::string number(double x);       // 6 digits, without trailing zeros
std::string place(const Vec2& at);  // "(x, y)" with 10 digits, enough for a millimetre on a map

}  // namespace talus
