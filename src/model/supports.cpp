#include "model/supports.hpp"

#include "core/text.hpp"

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

int axis_across(Side side) { return side == Side::left || side == Side::right ? 0 : 1; }

double extreme(const Box& outline, Side side) {
    switch (side) {
        case Side::left:
            return outline.xmin;
        case Side::right:
            return outline.xmax;
        case Side::bottom:
            return outline.ymin;
        default:
            return outline.ymax;
    }
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
    const int axis = axis_across(side);
    const auto on_line = [&](int k) { return std::abs(corner[k][axis] - extreme(outline, side)) <= tolerance; };
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

void hold_rock(const RockSpec& rock, std::span<const Vec2> corner, int rock_blocks, const Box& outline, Model& model,
               std::vector<Fault>& faults) {
    const HeldSpec& held = rock.held;
    const auto found_nothing = [&](const std::string& key, const std::string& what) {
        faults.push_back({rock.where, "rock.held." + key, "holds nothing: " + what});
    };
    const SideSupport supports[] = {held.left, held.right, held.bottom, held.top};
    for (int i = 0; i < 4; ++i) {
        if (supports[i] == SideSupport::none) continue;
        const auto edges = edges_on_side(model, corner, rock_blocks, outline, sides[i]);
        for (const OuterEdge& edge : edges) fix(fixity(supports[i], sides[i]), edge.block, model.blocks);
        if (edges.empty()) {
            const int axis = axis_across(sides[i]);
            found_nothing(side_names[i], std::string("no block has an edge along ") + "xy"[axis] + " = " +
                                             map_number(extreme(outline, sides[i]) + model.origin[axis]) +
                                             ", the farthest that the outline reaches; on an irregular outline use "
                                             "`below`, `above` or `inside`");
        }
    }

    const double tolerance = relative_tolerance * size(outline);
    const auto hold_where = [&](const std::string& key, const std::string& what, auto meant) {
        bool any = false;
        for (BlockId b = 0; b < rock_blocks; ++b)
            if (meant(b)) fix({true, true, true}, b, model.blocks), any = true;
        if (!any) found_nothing(key, what);
    };
    const auto height = [&](double y) { return "y = " + map_number(y + model.origin.y()); };
    if (held.below)
        hold_where("below", "no block reaches below " + height(*held.below) + "; the rock begins at " + height(outline.ymin),
                   [&](BlockId b) { return reach(model, corner, b, false) < *held.below - tolerance; });
    if (held.above)
        hold_where("above", "no block reaches above " + height(*held.above) + "; the rock ends at " + height(outline.ymax),
                   [&](BlockId b) { return reach(model, corner, b, true) > *held.above + tolerance; });
    for (std::size_t i = 0; i < held.inside.size(); ++i)
        hold_where("inside[" + std::to_string(i) + "]", "no block has its centroid inside this outline",
                   [&](BlockId b) { return contains(held.inside[i], model.blocks.start[b]); });
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
