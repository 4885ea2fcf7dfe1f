#include "verdict/way.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

double turn(const State& state, BlockId b) { return state.motion.angle[b] - state.start_angle[b]; }

double rocking_angle(const Model& model, BlockId b) {  // rad
    double width = 0.0;
    for (PartId p = model.blocks.first_part[b]; p < model.blocks.first_part[b + 1]; ++p)
        width = std::max(width, model.parts.thickness[p]);
    return std::asin(std::min(1.0, 0.5 * width / model.blocks.radius[b]));
}

}  // namespace

bool free_to_move(const Model& model, const State& state, BlockId b) {
    if (state.removed[b] || model.blocks.held(b)) return false;
    return std::ranges::none_of(model.driven, [b](const DrivenBlock& d) { return d.block == b; });
}

double free_area(const Model& model, const State& state) {
    double area = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        if (free_to_move(model, state, b)) area += model.blocks.area[b];
    return area;
}

double size_of(const Model& model, BlockId b) { return std::sqrt(model.blocks.area[b]); }

double turning_way(const Model& model, BlockId b, double angle) { return model.blocks.radius[b] * std::abs(angle); }

double way_gone(const Model& model, const State& state, BlockId b) {
    const double moved = (state.motion.position[b] - state.start_position[b]).norm();
    return std::max(moved, turning_way(model, b, turn(state, b)));
}

bool past_its_corner(const Model& model, BlockId b, double way, double angle) {
    return turning_way(model, b, angle) > a_part * way && std::abs(angle) >= rocking_angle(model, b);
}

bool is_far(const Model& model, const State& state, BlockId b) {
    const double way = way_gone(model, state, b);
    return way >= size_of(model, b) || past_its_corner(model, b, way, turn(state, b));
}

}  // namespace talus
