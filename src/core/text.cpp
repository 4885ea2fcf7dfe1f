#include "core/text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace talus {

std::string number(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", x);
    return text;
}

std::string map_number(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.10g", x);
    return text;
}

std::string place(const Vec2& at) { return "(" + map_number(at.x()) + ", " + map_number(at.y()) + ")"; }

std::string place(const Vec2& at, double size) {
    const double decimals = size > 0.0 ? std::clamp(std::ceil(2.0 - std::log10(size)), 0.0, 12.0) : 12.0;
    char text[96];
    const double unit = std::pow(10.0, -decimals);  // so that what rounds to nothing is not -0
    const auto shown = [&](double x) { return std::abs(x) < 0.5 * unit ? 0.0 : x; };
    std::snprintf(text, sizeof text, "(%.*f, %.*f)", static_cast<int>(decimals), shown(at.x()), static_cast<int>(decimals),
                  shown(at.y()));
    return text;
}

}  // namespace talus
