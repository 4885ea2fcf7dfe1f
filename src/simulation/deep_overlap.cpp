#include "simulation/deep_overlap.hpp"

#include "contact/separation.hpp"
#include "core/text.hpp"
#include "model/title.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace {

constexpr std::int64_t longest_interval = 128;  // steps; a look costs a tenth of a step at most

// The mean overlap of a contact is at least a fifth of its depth: a corner pressed in, with both of its edges and the edge
// it is pressed into, has about a third. Only above this share of the thickness the depth is found, which takes longer.
constexpr double worth_measuring = 0.02;

constexpr double room_share = 0.75;

bool borders_its_own_block(const Model& model, PartId part) {
    const auto* begin = &model.corners.internal[model.parts.first_corner[part]];
    return std::any_of(begin, begin + (model.parts.first_corner[part + 1] - model.parts.first_corner[part]),
                       [](std::uint8_t internal) { return internal != 0; });
}

// m: of the part; where it borders on another part of its block, of what lies behind the edges by which one gets in.
double thickness(const Model& model, PartId part) {
    if (!borders_its_own_block(model, part)) return model.parts.thickness[part];
    const BlockId block = model.parts.block[part];
    const int begin = model.parts.first_corner[model.blocks.first_part[block]],
              end = model.parts.first_corner[model.blocks.first_part[block + 1]];
    double least = std::numeric_limits<double>::infinity();
    for (int k = model.parts.first_corner[part]; k < model.parts.first_corner[part + 1]; ++k) {
        if (model.corners.internal[k]) continue;
        double behind = 0.0;
        for (int j = begin; j < end; ++j)
            behind = std::max(behind, model.corners.offset[k] - model.corners.normal[k].dot(model.corners.arm[j]));
        least = std::min(least, behind);
    }
    return std::isfinite(least) ? std::max(least, model.parts.thickness[part]) : model.parts.thickness[part];
}

// m, largest distance by which an edge that bounds its block keeps the parts apart; < 0: least depth.
double distance_by_outer_edges(const PlacedPart& p, const PlacedPart& other, double dx, double dy) {
    double largest = -std::numeric_limits<double>::infinity();
    for (int k = 0; k < p.n; ++k)
        if (!p.internal[k]) largest = std::max(largest, separation_by_edge(p, k, other, dx, dy));
    return largest;
}

double depth(const Model& model, const Placed& placed, const Contact& c) {
    const PlacedPart a(model, placed, c.part_a), b(model, placed, c.part_b);
    const Vec2 way = placed.block[model.parts.block[c.part_b]].position - placed.block[model.parts.block[c.part_a]].position;
    return -std::max(distance_by_outer_edges(a, b, way.x(), way.y()), distance_by_outer_edges(b, a, -way.x(), -way.y()));
}

class Deepest {
public:
    Deepest(const Model& model, const Placed& placed) : model_(model), placed_(placed) {}
    DeepOverlap found;

    void look_at(const Contact& c) {
        if (!c.touching || c.overlap <= 0.0) return;
        const double least = std::min(model_.parts.thickness[c.part_a], model_.parts.thickness[c.part_b]);
        const bool measured = c.overlap > worth_measuring * least;
        const double thin = measured ? std::min(thickness(model_, c.part_a), thickness(model_, c.part_b)) : least;
        const double here = measured ? depth(model_, placed_, c) : c.overlap;
        if (here <= most_ * thin) return;
        most_ = here / thin;
        found = {&c, here, thin, room_share * thin, c.point};
    }

private:
    const Model& model_;
    const Placed& placed_;
    double most_ = 0.0;  // of its thickness
};

std::string refusal(const Model& model, const State& state, const DeepOverlap& deepest) {
    if (!deepest.contact || deepest.depth <= deepest.room) return {};
    return "blocks lie in each other, and would pass through: overlap " + describe(model, deepest) + "; " +
           remedy(model, deepest) + "; t = " + number(state.time) + " s, step " + std::to_string(state.total_steps);
}

}  // namespace

DeepOverlap deepest_overlap(const Model& model, const Placed& placed, const State& state) {
    Deepest deepest(model, placed);
    for (const Contact& c : state.contacts.list) deepest.look_at(c);
    return deepest.found;
}

std::string describe(const Model& model, const DeepOverlap& overlap) {
    const Contact& c = *overlap.contact;
    return number(overlap.depth) + " m, " + number(std::round(1e4 * overlap.share()) / 100.0) + " % of the thinner part (" +
           number(overlap.thickness) + " m), between " + title(model, model.parts.block[c.part_a]) + " and " +
           title(model, model.parts.block[c.part_b]) + " at " + place(overlap.point + model.origin, overlap.thickness);
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

bool rare_look(std::int64_t step) { return step % longest_interval == 0; }

std::string no_room_left(const Model& model, const Placed& placed, const State& state) {
    return refusal(model, state, deepest_overlap(model, placed, state));
}

std::string no_room_left(const Model& model, const Placed& placed, const State& state, const Awake& awake,
                         const ContactIndex& index) {
    Deepest deepest(model, placed);
    for (const BlockRange& range : awake.moving) {
        for (int i = index.first_a[range.begin]; i < index.first_a[range.end]; ++i) deepest.look_at(state.contacts.list[i]);
        for (int e = index.first_b[range.begin]; e < index.first_b[range.end]; ++e)
            deepest.look_at(state.contacts.list[index.slot_b[e]]);
    }
    return refusal(model, state, deepest.found);
}

std::string no_room_left(const Model& model, const Placed& placed, const State& state, const Contact& c, double depth) {
    const BlockId a = model.parts.block[c.part_a], b = model.parts.block[c.part_b];
    const double thin = std::min(thickness(model, c.part_a), thickness(model, c.part_b));
    const DeepOverlap overlap{&c, depth, thin, room_share * thin,
                              placed.block[model.blocks.area[a] < model.blocks.area[b] ? a : b].position};
    if (depth <= overlap.room) return {};
    return "blocks lie in each other, and would pass through: overlap " + describe(model, overlap) + "; " + rigid_remedy +
           "; t = " + number(state.time) + " s, step " + std::to_string(state.total_steps);
}

}  // namespace talus
