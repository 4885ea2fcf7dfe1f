#include "model/box_axes.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace talus {
namespace {

constexpr int quarter = 90;  // degrees, and one bin each: perpendicular directions are the same to a pair of axes
constexpr int near = 3;      // degrees; boxes grow with the turn, thin slabs by their length x its sine, so hardly more
constexpr double few = 0.01;

using LengthByDirection = std::array<double, quarter>;  // m

LengthByDirection length_by_direction(const Corners& corners) {
    LengthByDirection length{};
    for (int k = 0; k < corners.size(); ++k) {
        if (corners.internal[k]) continue;
        const double angle_deg = std::atan2(corners.normal[k].y(), corners.normal[k].x()) * 180.0 / std::numbers::pi;
        length[(static_cast<int>(std::lround(angle_deg)) + 4 * quarter) % quarter] += corners.length[k];
    }
    return length;
}

double length_near(const LengthByDirection& length, int angle_deg) {
    double sum = 0.0;
    for (int d = -near; d <= near; ++d) sum += length[(angle_deg + d + 2 * quarter) % quarter];
    return sum;
}

}  // namespace

Vec2 box_axis(const Corners& corners) {
    const LengthByDirection length = length_by_direction(corners);
    double all = 0.0;
    for (const double here : length) all += here;
    int best = 0;
    for (int turn = 1; turn <= quarter / 2; ++turn)
        for (const int angle_deg : {turn, -turn})
            if (length_near(length, angle_deg) < length_near(length, best)) best = angle_deg;
    if (length_near(length, 0) <= 2.0 * length_near(length, best) + few * all) return Vec2::UnitX();
    const double angle = best * std::numbers::pi / 180.0;
    return {std::cos(angle), std::sin(angle)};
}

}  // namespace talus
