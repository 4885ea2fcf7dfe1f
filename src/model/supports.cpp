#include "model/supports.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

constexpr double relative_tolerance = 1e-9;

double size(const Box& box) { return std::max(box.xmax - box.xmin, box.ymax - box.ymin); }

void fix(const Fixity& held, BlockId block, Blocks& blocks) {
    if (held.x) blocks.inv_mass[block].x() = 0.0;
    if (held.y) blocks.inv_mass[block].y() = 0.0;
    if (held.rotation) blocks.inv_inertia[block] = 0.0;
}

// A roller keeps a side plane: no motion across it and no rotation.
Fixity fixity(SideSupport support, Side side) {
    if (support == SideSupport::held) return {true, true, true};
    const bool upright = side == Side::left || side == Side::right;
    return {upright, !upright, true};
}

double reach(const Model& model, std::span<const Vec2> corner, BlockId block, bool up) {
    const std::vector<int>& first = model.parts.first_corner;
    const auto own = corner.subspan(first[model.blocks.first_part[block]],
                                    first[model.blocks.first_part[block + 1]] - first[model.blocks.first_part[block]]);
    const Box box = bounds(own);
    return up ? box.ymax : box.ymin;
}

}  // namespace

std::vector<OuterEdge> edges_on_side(const Model& model, std::span<const Vec2> corner, int blocks, const Box& outline,
                                     Side side) {
    const double tolerance = relative_tolerance * size(outline);
    const int axis = side == Side::left || side == Side::right ? 0 : 1;
    const double line = side == Side::left     ? outline.xmin
                        : side == Side::right  ? outline.xmax
                        : side == Side::bottom ? outline.ymin
                                               : outline.ymax;
    const auto on_line = [&](int k) { return std::abs(corner[k][axis] - line) <= tolerance; };
    std::vector<OuterEdge> edges;
    for (PartId p = 0; p < model.blocks.first_part[blocks]; ++p) {
        const int first = model.parts.first_corner[p], last = model.parts.first_corner[p + 1];
        for (int k = first; k < last; ++k) {
            const int next = k + 1 < last ? k + 1 : first;
            if (!model.corners.internal[k] && on_line(k) && on_line(next)) edges.push_back({model.parts.block[p], k, next});
        }
    }
    return edges;
}

void hold_rock(const HeldSpec& held, std::span<const Vec2> corner, int rock_blocks, const Box& outline, Model& model) {
    const SideSupport supports[] = {held.left, held.right, held.bottom, held.top};
    for (int i = 0; i < 4; ++i)
        if (supports[i] != SideSupport::none)
            for (const OuterEdge& edge : edges_on_side(model, corner, rock_blocks, outline, sides[i]))
                fix(fixity(supports[i], sides[i]), edge.block, model.blocks);

    const double tolerance = relative_tolerance * size(outline);
    for (BlockId b = 0; b < rock_blocks; ++b) {
        const bool inside = std::any_of(held.inside.begin(), held.inside.end(),
                                        [&](const Polygon& area) { return contains(area, model.blocks.start[b]); });
        if (inside || (held.below && reach(model, corner, b, false) < *held.below - tolerance) ||
            (held.above && reach(model, corner, b, true) > *held.above + tolerance))
            fix({true, true, true}, b, model.blocks);
    }
}

void hold_block(const BlockSpec& spec, BlockId block, Model& model) {
    const DrivenSpec& driven = spec.driven;
    const Fixity axes{driven.velocity_x.has_value(), driven.velocity_y.has_value(), driven.spin.has_value()};
    fix(spec.held, block, model.blocks);
    fix(axes, block, model.blocks);
    if (axes.x || axes.y || axes.rotation)
        model.driven.push_back({block, axes.x, axes.y, axes.rotation, driven.velocity_x.value_or(TimeTable{}),
                                driven.velocity_y.value_or(TimeTable{}), driven.spin.value_or(TimeTable{})});
}

std::vector<std::uint8_t> immovable(const Model& model) {
    std::vector<std::uint8_t> fixed(model.blocks.size());
    for (BlockId b = 0; b < model.blocks.size(); ++b) fixed[b] = model.blocks.held(b);
    for (const DrivenBlock& driven : model.driven) fixed[driven.block] = 0;
    return fixed;
}

}  // namespace talus
