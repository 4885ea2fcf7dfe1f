#include "core/text.hpp"

#include <cstdio>

namespace talus {

std::string number(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", x);
    return text;
}

std::string place(const Vec2& at) {
    char text[64];
    std::snprintf(text, sizeof text, "(%.10g, %.10g)", at.x(), at.y());
    return text;
}

}  // namespace talus
