// Blocks in the making: outlines in, parts, corners and mass properties out.
#pragma once

#include "model/model.hpp"

#include <string>
#include <vector>

namespace talus {

struct Shape {
    std::vector<Polygon> parts;  // m, convex, counter-clockwise
    int material = 0;
    int region = -1;
    std::string name;
};

/// Fills blocks, parts and corners (every block free) and returns the corners [nc] in m as they were given.
/// density[material] in kg/m3. Arms count from the centroid as it is stored, rounding included, so that touching blocks
/// touch exactly however far they are from the origin.
std::vector<Vec2> fill_blocks(const std::vector<Shape>& shapes, std::span<const double> density, Model& model);

}  // namespace talus
