#include "model/rounding.hpp"

#include <algorithm>

namespace talus {
namespace {

// An arc flatter than 28 degrees, tangent at the rounding length, would be larger than many a block. It gets this many cuts
// as its radius, and so cuts off less than a quarter. Half or twice of it: corners flatter than 53 or 14 degrees.
constexpr double largest_radius = 4.0;

// m, the cut with which the circle of corner k just touches another edge of the part.
double cut_that_fits(const Corners& corners, int begin, int end, int k, int before) {
    const CornerArc unit = corner_arc(corners.normal[before], corners.normal[k], 1.0);
    // The centre moves away from the tip in proportion to the cut.
    const Vec2 centre = unit.cut * perp(corners.normal[k]) - unit.radius * corners.normal[k];
    double largest = std::numeric_limits<double>::infinity();
    for (int j = begin; j < end; ++j) {
        if (j == k || j == before) continue;
        const double room = corners.offset[j] - corners.normal[j].dot(corners.arm[k]);
        const double taken = unit.radius + corners.normal[j].dot(centre);
        if (taken > 0.0) largest = std::min(largest, std::max(room, 0.0) / taken);
    }
    return largest;
}

}  // namespace

CornerArc corner_arc(const Vec2& before, const Vec2& after, double cut) {
    // With turning angle phi of the outline at the corner, radius = cut / tan(phi / 2).
    const double sine = cross(before, after), one_and_cosine = 1.0 + before.dot(after);
    if (one_and_cosine > largest_radius * sine)
        return {largest_radius * cut * std::max(sine, 0.0) / one_and_cosine, largest_radius * cut};
    return {cut, cut * one_and_cosine / sine};
}

std::vector<double> corner_cuts(const Model& model, double length) {
    const Corners& corners = model.corners;
    std::vector<double> cuts(corners.size());
    for (PartId p = 0; p < model.parts.size(); ++p) {
        const int begin = model.parts.first_corner[p], end = model.parts.first_corner[p + 1];
        for (int k = begin; k < end; ++k) {
            const int before = k == begin ? end - 1 : k - 1;
            const double half_edge = 0.5 * std::min(corners.length[before], corners.length[k]);
            cuts[k] = std::min({length, half_edge, cut_that_fits(corners, begin, end, k, before)});
        }
    }
    return cuts;
}

}  // namespace talus
