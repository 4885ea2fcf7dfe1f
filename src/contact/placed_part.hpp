// A convex part as the contact geometry sees it: turned corners, edge normals and edge offsets, from its block's centroid.
#pragma once

#include "model/model.hpp"
#include "model/placed.hpp"

namespace talus {

struct PlacedPart {
    const PlacedCorner* corner;    // [n]
    const double* offset;          // [n] m
    const double* length;          // [n] m
    const std::uint8_t* internal;  // [n]
    int n;
    int first;  // global index of corner 0

    PlacedPart(const Model& model, const Placed& placed, PartId part)
        : corner(&placed.corner[model.parts.first_corner[part]]),
          offset(&model.corners.offset[model.parts.first_corner[part]]),
          length(&model.corners.length[model.parts.first_corner[part]]),
          internal(&model.corners.internal[model.parts.first_corner[part]]),
          n(model.parts.first_corner[part + 1] - model.parts.first_corner[part]),
          first(model.parts.first_corner[part]) {}

    const Vec2& arm(int k) const { return corner[k].arm; }  // m
    const Vec2& normal(int k) const { return corner[k].normal; }
    int next(int k) const { return k + 1 == n ? 0 : k + 1; }
    int previous(int k) const { return k == 0 ? n - 1 : k - 1; }
};

}  // namespace talus
