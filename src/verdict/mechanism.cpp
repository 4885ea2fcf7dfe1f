#include "verdict/mechanism.hpp"

#include "model/material_point.hpp"
#include "verdict/way.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace talus {
namespace {

// Of the weight, that contacts carry in the mean of a window: less is nothing. A block on a plane without friction feels
// that much of it at 88 degrees; blocks that fall side by side rub each other by less.
constexpr double hardly_carried = 0.03;
constexpr std::size_t mass = 3;  // blocks: fewer turn or slide each by itself
constexpr double common = 0.9;   // of the motion of all, that one rigid motion accounts for
// Of it, by turning. A mass of length l in a round trough of radius r has l^2 / 12 r^2; one that is shorter than 0.8 r
// slides.
constexpr double mostly_turns = 0.05;
constexpr double half = 0.5;

// A block that has not set out itself, though its riders have moved visibly, is looked at now.
bool set_out_with_slip(const Model& model, const State& state, const Footing& footing, BlockId base) {
    const SetOut found = state.course.set_out[base];
    return found == SetOut::not_yet ? slips(model, state, footing, base) : found == SetOut::with_slip;
}

// Whether there is one block alone that it touches: then nothing but its own weight turns it.
bool is_alone(const Model& model, const State& state, BlockId b) {
    BlockId other = -1;
    for (const Contact& c : state.contacts.list) {
        const BlockId a = model.parts.block[c.part_a], q = model.parts.block[c.part_b];
        if (!c.touching || (a != b && q != b)) continue;
        const BlockId touched = a == b ? q : a;
        if (other >= 0 && touched != other) return false;
        other = touched;
    }
    return true;
}

double turn_of(const State& state, BlockId b) { return state.motion.angle[b] - state.start_angle[b]; }

// A rider turns like its base when it is part of what leans over; it does not when a small block rolls beneath it.
Mechanism on_its_base(const Model& model, const State& state, BlockId rider, BlockId base, bool with_slip) {
    const bool turns_along =
        turn_of(state, rider) * turn_of(state, base) >= half * turn_of(state, base) * turn_of(state, base);
    const BlockId b = turns_along ? base : rider;
    const double least = (is_alone(model, state, b) ? a_part_alone : a_part) * way_gone(model, state, b);
    if (turning_way(model, b, turn_of(state, b)) <= least + no_motion * state.course.give) return Mechanism::slide;
    return with_slip ? Mechanism::slide_and_topple : Mechanism::topple;
}

// m/s2, without contacts, in the mean of the window.
Vec2 free_acceleration(const Model& model, const State& state, BlockId b) {
    const double end = state.stage_time, begin = end - (state.time - state.course.window_begin);
    Vec2 all(0.5 * (model.gravity_x(begin) + model.gravity_x(end)), 0.5 * (model.gravity_y(begin) + model.gravity_y(end)));
    for (const Load& l : model.loads)
        if (l.block == b) all += Vec2(l.force_x(end), l.force_y(end)) / model.blocks.mass[b];
    return (1.0 - model.local_damping) * all;
}

// m2, mean square way of the points of a body that turns by `angle` (rad), without inertia.
double square_way(double angle) { return 2.0 * (1.0 - std::cos(angle)); }

// Whether the centre about which all turn by `angle` (rad), while their centroid goes this way (m), lies above the centroid,
// as in a round slip: the mass swings out below, and lies back. What leans over turns about its toe, or slips there and
// turns about a point still lower.
bool swings_out(const Model& model, const State& state, const Vec2& way, double angle) {
    const Vec2 to_centre = 0.5 * (way + perp(way) / std::tan(0.5 * angle));
    return model.gravity_x(state.stage_time) * to_centre.x() + model.gravity_y(state.stage_time) * to_centre.y() < 0.0;
}

// Whether the blocks move like one rigid body in a round slip: all their points go where one rigid motion takes them, that
// with the least squares over the whole mass; I of a block counts for its own points.
bool rotates_as_one(const Model& model, const State& state, const std::vector<BlockId>& blocks) {
    if (blocks.size() < mass) return false;
    double m = 0.0;
    Vec2 start = Vec2::Zero(), end = Vec2::Zero(), way = Vec2::Zero();
    for (const BlockId b : blocks) {
        m += model.blocks.mass[b];
        start += model.blocks.mass[b] * state.start_position[b];
        end += model.blocks.mass[b] * state.motion.position[b];
        way += model.blocks.mass[b] * (state.motion.position[b] - state.start_position[b]);
    }
    start /= m, end /= m;
    double sine = 0.0, cosine = 0.0;
    for (const BlockId b : blocks) {
        const Vec2 from = state.start_position[b] - start, to = state.motion.position[b] - end;
        const double turn = turn_of(state, b);
        sine += model.blocks.mass[b] * cross(from, to) + model.blocks.inertia[b] * std::sin(turn);
        cosine += model.blocks.mass[b] * from.dot(to) + model.blocks.inertia[b] * std::cos(turn);
    }
    const double angle = std::atan2(sine, cosine);
    double all = 0.0, left = 0.0, by_turning = 0.0;
    for (const BlockId b : blocks) {
        const Vec2 from = state.start_position[b] - start, to = state.motion.position[b] - end,
                   turned_from = turned(from, angle);
        const double turn = turn_of(state, b), inertia = model.blocks.inertia[b];
        all += model.blocks.mass[b] * (state.motion.position[b] - state.start_position[b]).squaredNorm() +
               inertia * square_way(turn);
        left += model.blocks.mass[b] * (to - turned_from).squaredNorm() + inertia * square_way(turn - angle);
        by_turning += model.blocks.mass[b] * (turned_from - from).squaredNorm() + inertia * square_way(angle);
    }
    return left < (1.0 - common) * all && by_turning > mostly_turns * all && swings_out(model, state, way / m, angle);
}

struct Shares {
    double slipping = 0.0, turning = 0.0, falling = 0.0;  // m2
};

// Of blocks that fall the rest is silent: they have left their joints.
Mechanism most_of(const Shares& area, double all) {
    if (area.falling > half * all) return Mechanism::fall;
    const double carried = all - area.falling;
    const bool slip = area.slipping >= half * carried, turn = area.turning >= half * carried;
    return slip && turn ? Mechanism::slide_and_topple : turn ? Mechanism::topple : Mechanism::slide;
}

}  // namespace

bool slips(const Model& model, const State& state, const Footing& footing, BlockId b) {
    const Base base = footing.base(model, state, b);
    return base.slip > a_slip * way_gone(model, state, base.block) + no_motion * state.course.give;
}

bool fell_freely(const Model& model, const State& state, const Footing& footing, BlockId b) {
    const Vec2 free = free_acceleration(model, state, b);
    if (free.isZero()) return !footing.carried(b);
    const Vec2 gained =
        (state.motion.velocity[b] - state.course.velocity_begin[b]) / (state.time - state.course.window_begin);
    return (gained - free).norm() < hardly_carried * free.norm();
}

Mechanism mechanism_of(const Model& model, const State& state, const Footing& footing, BlockId b) {
    if (state.course.fell[b]) return Mechanism::fall;
    const BlockId base = footing.base(model, state, b).block;
    return on_its_base(model, state, b, base, set_out_with_slip(model, state, footing, base));
}

Mechanism mechanism_seen_now(const Model& model, const State& state, const Footing& footing, BlockId b) {
    if (!footing.carried(b)) return Mechanism::fall;
    return on_its_base(model, state, b, footing.base(model, state, b).block, slips(model, state, footing, b));
}

Mechanism mechanism_of_the_mass(const Model& model, const State& state, std::vector<Mechanism>& block_mechanism) {
    std::vector<BlockId> blocks;
    Shares area;
    double all = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        const Mechanism m = block_mechanism[b];
        if (m == Mechanism::none) continue;
        blocks.push_back(b);
        all += model.blocks.area[b];
        if (m == Mechanism::slide || m == Mechanism::slide_and_topple) area.slipping += model.blocks.area[b];
        if (m == Mechanism::topple || m == Mechanism::slide_and_topple) area.turning += model.blocks.area[b];
        if (m == Mechanism::fall) area.falling += model.blocks.area[b];
    }
    if (blocks.empty()) return Mechanism::none;
    const Mechanism most = most_of(area, all);
    if (most == Mechanism::topple || most == Mechanism::fall || !rotates_as_one(model, state, blocks)) return most;
    for (const BlockId b : blocks) block_mechanism[b] = Mechanism::rotation;
    return Mechanism::rotation;
}

}  // namespace talus
