#include "model/shapes.hpp"

#include "geometry/polygon.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

struct Measures {
    double area = 0.0;             // m2
    Vec2 centroid = Vec2::Zero();  // m
    double polar_moment = 0.0;     // m4, about the centroid
};

Measures measure(const std::vector<Polygon>& parts) {
    Measures all;
    const Vec2 reference = parts.front().front();
    Vec2 first_moment = Vec2::Zero();
    for (const Polygon& part : parts) {
        const double area = signed_area(part);
        all.area += area;
        first_moment += area * (centroid(part) - reference);
    }
    all.centroid = reference + first_moment / all.area;
    for (const Polygon& part : parts)
        all.polar_moment += polar_moment(part) + signed_area(part) * (centroid(part) - all.centroid).squaredNorm();
    return all;
}

double radius(const std::vector<Polygon>& parts, const Vec2& centre) {
    double largest = 0.0;
    for (const Polygon& part : parts)
        for (const Vec2& p : part) largest = std::max(largest, (p - centre).norm());
    return largest;
}

void add_part(const Polygon& polygon, BlockId block, Model& model) {
    model.parts.block.push_back(block);
    model.parts.thickness.push_back(smallest_width(polygon));
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Vec2 edge = polygon[(k + 1) % polygon.size()] - polygon[k];
        const double length = edge.norm();
        const Vec2 arm = polygon[k] - model.blocks.start[block], normal = -perp(edge) / length;
        model.corners.arm.push_back(arm);
        model.corners.normal.push_back(normal);
        model.corners.offset.push_back(normal.dot(arm));
        model.corners.length.push_back(length);
        model.corners.internal.push_back(0);
    }
    model.parts.first_corner.push_back(model.corners.size());
}

// True if the middle of edge i lies on edge j, which faces it: seen from inside the block there is no boundary.
bool faces(const Corners& corners, int i, int j) {
    const Vec2 middle = corners.arm[i] + 0.5 * corners.length[i] * perp(corners.normal[i]);
    const Vec2 from_j = middle - corners.arm[j];
    const double along = perp(corners.normal[j]).dot(from_j), apart = corners.normal[j].dot(from_j);
    return corners.normal[i].dot(corners.normal[j]) < -0.5 && along > 0.0 && along < corners.length[j] &&
           std::abs(apart) < 1e-9 * corners.length[i];
}

void mark_internal_edges(BlockId block, Model& model) {
    const int first = model.parts.first_corner[model.blocks.first_part[block]], last = model.corners.size();
    for (int i = first; i < last; ++i)
        for (int j = first; j < last; ++j)
            if (faces(model.corners, i, j)) model.corners.internal[i] = 1;
}

// An ear that a sliver left on the block it was merged with is no wall that something could pass through: blocks on both
// sides of it meet by closing their joints. It takes the thickness of its block, or every step would be too long for it.
// Twice or half of these shares are still far from what anybody draws, and above what the default of `slivers` leaves.
void overlook_ears(const std::vector<Polygon>& shape, double area, Model& model) {
    constexpr double of_the_area = 1e-4, of_the_thickness = 1e-3;
    const auto first = model.parts.thickness.end() - static_cast<std::ptrdiff_t>(shape.size());
    const double thickest = *std::max_element(first, model.parts.thickness.end());
    for (std::size_t k = 0; k < shape.size(); ++k) {
        double& thickness = first[static_cast<std::ptrdiff_t>(k)];
        if (thickness < of_the_thickness * thickest && signed_area(shape[k]) < of_the_area * area) thickness = thickest;
    }
}

}  // namespace

std::vector<Vec2> fill_blocks(const std::vector<Shape>& shapes, std::span<const double> density, Model& model) {
    Blocks& blocks = model.blocks;
    std::vector<Vec2> given;
    blocks.first_part.push_back(0);
    model.parts.first_corner.push_back(0);
    for (const Shape& shape : shapes) {
        const BlockId block = blocks.size();
        const Measures size = measure(shape.parts);
        const double mass = size.area * density[shape.material], inertia = size.polar_moment * density[shape.material];
        blocks.area.push_back(size.area);
        blocks.mass.push_back(mass);
        blocks.inertia.push_back(inertia);
        blocks.inv_mass.push_back(Vec2::Constant(1.0 / mass));
        blocks.inv_inertia.push_back(1.0 / inertia);
        blocks.start.push_back(size.centroid);
        blocks.material.push_back(shape.material);
        blocks.name.push_back(shape.name);
        blocks.region.push_back(shape.region);
        for (const Polygon& part : shape.parts) {
            add_part(part, block, model);
            given.insert(given.end(), part.begin(), part.end());
        }
        blocks.first_part.push_back(model.parts.size());
        blocks.radius.push_back(radius(shape.parts, size.centroid));
        if (shape.parts.size() == 1) continue;
        mark_internal_edges(block, model);
        overlook_ears(shape.parts, size.area, model);
    }
    return given;
}

}  // namespace talus
