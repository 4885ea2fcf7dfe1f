#include "simulation/deep_overlap.hpp"

#include "contact/separation.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

constexpr std::int64_t longest_interval = 128;  // steps; a look costs a tenth of a step at most

// The mean overlap of a contact is at least a fifth of its depth: a corner pressed in, with both of its edges and the edge
// it is pressed into, has about a third. Only above this share of the thickness the depth is found, which takes longer.
constexpr double worth_measuring = 0.02;

bool borders_its_own_block(const Model& model, PartId part) {
    const auto* begin = &model.corners.internal[model.parts.first_corner[part]];
    return std::any_of(begin, begin + (model.parts.first_corner[part + 1] - model.parts.first_corner[part]),
                       [](std::uint8_t internal) { return internal != 0; });
}

double room(const Model& model, PartId part) {
    return (borders_its_own_block(model, part) ? 1.0 : 0.75) * model.parts.thickness[part];
}

double depth(const Model& model, const Placed& placed, const Contact& c) {
    const Vec2 way = placed.block[model.parts.block[c.part_b]].position - placed.block[model.parts.block[c.part_a]].position;
    return -separation({model, placed, c.part_a}, {model, placed, c.part_b}, way.x(), way.y()).distance;
}

std::string title(const Model& model, BlockId block) {
    const std::string& name = model.blocks.name[block];
    return "block " + std::to_string(block) + (name.empty() ? "" : " `" + name + "`");
}

}  // namespace

DeepOverlap deepest_overlap(const Model& model, const Placed& placed, const State& state) {
    DeepOverlap deepest;
    double most = 0.0;  // of its room that a contact has used
    for (const Contact& c : state.contacts.list) {
        if (!c.touching || c.overlap <= 0.0) continue;
        const double thin = std::min(model.parts.thickness[c.part_a], model.parts.thickness[c.part_b]);
        const double there = std::min(room(model, c.part_a), room(model, c.part_b));
        const double here = c.overlap > worth_measuring * thin ? depth(model, placed, c) : c.overlap;
        if (here <= most * there) continue;
        most = here / there;
        deepest = {&c, here, thin, there};
    }
    return deepest;
}

std::string describe(const Model& model, const DeepOverlap& overlap) {
    const Contact& c = *overlap.contact;
    return number(overlap.depth) + " m, " + number(std::round(1e4 * overlap.share()) / 100.0) + " % of the thinner part (" +
           number(overlap.thickness) + " m), between " + title(model, model.parts.block[c.part_a]) + " and " +
           title(model, model.parts.block[c.part_b]) + " at " + place(c.point + model.origin, overlap.thickness);
}

std::string remedy(const Model& model, const DeepOverlap& overlap) {
    const Joint& joint = model.joints[overlap.contact->joint];
    return "a normal stiffness of at least " + number(joint.kn * overlap.share() / 0.01) + " Pa/m of joint `" + joint.name +
           "` would keep it near 1 %";
}

bool time_to_look(std::int64_t step, double speed, double dt, double thinnest) {
    std::int64_t interval = longest_interval;
    while (interval > 1 && 8.0 * static_cast<double>(interval) * speed * dt > thinnest) interval /= 2;
    return step % interval == 0;
}

std::string no_room_left(const Model& model, const Placed& placed, const State& state) {
    const DeepOverlap deepest = deepest_overlap(model, placed, state);
    if (!deepest.contact || deepest.depth <= deepest.room) return {};
    return "blocks lie in each other, and would pass through: overlap " + describe(model, deepest) + "; " +
           remedy(model, deepest) + "; t = " + number(state.time) + " s, step " + std::to_string(state.total_steps);
}

}  // namespace talus
