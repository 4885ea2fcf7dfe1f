#include "verdict/conclude.hpp"

#include "core/text.hpp"
#include "model/material_point.hpp"
#include "model/measure.hpp"
#include "verdict/course.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace talus {
namespace {

constexpr double at_the_end = 0.5;  // of the windows that are waited for when a run may end before its time
// Of the way of the block that goes farthest in a static stage: it takes along what moves with it, and leaves behind what
// only gives.
constexpr double takes_along = 0.25;
constexpr std::size_t mass = 3;  // blocks: fewer turn or slide each by itself
constexpr double common = 0.9;   // of the motion of all, that one rigid motion accounts for
// Of it, by turning. A mass of length l in a round trough of radius r has l^2 / 12 r^2; one that is shorter than 0.8 r
// slides.
constexpr double mostly_turns = 0.05;

double ratio(double now, double before) { return before > 0.0 ? now / before : 0.0; }

std::string block_text(const Model& model, BlockId b) {
    const std::string& name = model.blocks.name[b];
    return "block " + std::to_string(b) + (name.empty() ? "" : " '" + name + "'") + " at " +
           place(model.blocks.start[b] + model.origin, std::sqrt(model.blocks.area[b]));
}

std::vector<BlockId> moving_blocks(const StabilityVerdict& v) {
    std::vector<BlockId> all;
    for (std::size_t b = 0; b < v.block_mechanism.size(); ++b)
        if (v.block_mechanism[b] != Mechanism::none) all.push_back(static_cast<BlockId>(b));
    return all;
}

// m2, mean square way of the points of a body that turns by `angle` (rad), without inertia.
double square_way(double angle) { return 2.0 * (1.0 - std::cos(angle)); }

// Whether the blocks move like one rigid body that turns: all their points go where one rigid motion takes them, that with
// the least squares over the whole mass; I of a block counts for its own points.
bool turns_as_one(const Model& model, const State& state, const std::vector<BlockId>& blocks) {
    if (blocks.size() < mass) return false;
    double m = 0.0;
    Vec2 start = Vec2::Zero(), end = Vec2::Zero();
    for (const BlockId b : blocks) {
        m += model.blocks.mass[b];
        start += model.blocks.mass[b] * state.start_position[b];
        end += model.blocks.mass[b] * state.motion.position[b];
    }
    start /= m, end /= m;
    double sine = 0.0, cosine = 0.0;
    for (const BlockId b : blocks) {
        const Vec2 from = state.start_position[b] - start, to = state.motion.position[b] - end;
        const double turn = state.motion.angle[b] - state.start_angle[b];
        sine += model.blocks.mass[b] * cross(from, to) + model.blocks.inertia[b] * std::sin(turn);
        cosine += model.blocks.mass[b] * from.dot(to) + model.blocks.inertia[b] * std::cos(turn);
    }
    const double angle = std::atan2(sine, cosine);
    double all = 0.0, left = 0.0, by_turning = 0.0;
    for (const BlockId b : blocks) {
        const Vec2 from = state.start_position[b] - start, to = state.motion.position[b] - end,
                   turned_from = turned(from, angle);
        const double turn = state.motion.angle[b] - state.start_angle[b], inertia = model.blocks.inertia[b];
        all += model.blocks.mass[b] * (state.motion.position[b] - state.start_position[b]).squaredNorm() +
               inertia * square_way(turn);
        left += model.blocks.mass[b] * (to - turned_from).squaredNorm() + inertia * square_way(turn - angle);
        by_turning += model.blocks.mass[b] * (turned_from - from).squaredNorm() + inertia * square_way(angle);
    }
    return left < (1.0 - common) * all && by_turning > mostly_turns * all;
}

/// The mechanism of most of the moving area; of a mass that slips and turns as one, its rotation.
Mechanism of_the_mass(const Model& model, const State& state, StabilityVerdict& v) {
    const std::vector<BlockId> blocks = moving_blocks(v);
    std::array<double, mechanism_names.size()> area{};
    for (const BlockId b : blocks) area[static_cast<std::size_t>(v.block_mechanism[b])] += model.blocks.area[b];
    const auto most = static_cast<Mechanism>(std::ranges::max_element(area) - area.begin());
    const bool slips = most == Mechanism::slide || most == Mechanism::slide_and_topple;
    if (!slips || !turns_as_one(model, state, blocks)) return most;
    for (const BlockId b : blocks) v.block_mechanism[b] = Mechanism::rotation;
    return Mechanism::rotation;
}

void count(const Model& model, const State& state, StabilityVerdict& v) {
    std::vector<std::uint8_t> touched(model.blocks.size(), 0);
    for (const Contact& c : state.contacts.list)
        if (c.touching) touched[model.parts.block[c.part_a]] = touched[model.parts.block[c.part_b]] = 1;
    const std::vector<BlockId> blocks = moving_blocks(v);
    v.moving_blocks = static_cast<int>(blocks.size());
    for (const BlockId b : blocks) {
        v.moving_area += model.blocks.area[b];
        v.detached_blocks += !touched[b];
    }
    if (v.moving_blocks > 0) v.mechanism = of_the_mass(model, state, v);
}

StabilityVerdict begin(const Model& model, const State& state) {
    StabilityVerdict v;
    v.time = state.time;
    v.unbalanced_ratio = unbalanced_ratio(model, state);
    v.kinetic_energy = kinetic_energy(model, state);
    v.block_mechanism.assign(model.blocks.size(), Mechanism::none);
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        if (!model.blocks.held(b) && !state.removed[b])
            v.max_displacement = std::max(v.max_displacement, (state.motion.position[b] - state.start_position[b]).norm());
    return v;
}

BlockId fastest(const Model& model, const State& state, bool of_those_that_move, const StabilityVerdict& v) {
    BlockId found = -1;
    double most = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (!free_to_move(model, state, b) || (of_those_that_move && v.block_mechanism[b] == Mechanism::none)) continue;
        const double way = state.course.speed[b] / std::sqrt(model.blocks.area[b]);
        if (found < 0 || way > most) found = b, most = way;
    }
    return found;
}

std::string motion_text(const Model& model, const State& state, BlockId b) {
    const Course& c = state.course;
    const double way = way_gone(model, state, b);
    std::ostringstream text;
    text.precision(3);
    text << block_text(model, b) << " has gone " << way << " m, " << way / std::sqrt(model.blocks.area[b])
         << " of its size, at " << c.speed[b] << " m/s in the mean of the last " << c.window << " s and "
         << c.speed_before[b] << " m/s before";
    return text.str();
}

std::string reason(const Model& model, const State& state, bool loads_are_on, const StabilityVerdict& v) {
    const Course& c = state.course;
    const BlockId b = fastest(model, state, v.verdict == Stability::unstable, v);
    std::ostringstream text;
    text.precision(3);
    if (b < 0) return "nothing is free to move";
    if (v.verdict == Stability::unstable) {
        const char* how = v.block_mechanism[b] == Mechanism::fall ? "falls: " : "goes on: ";
        text << how << motion_text(model, state, b);
    } else if (v.verdict == Stability::stable) {
        text << "all blocks that are free rest, or come no further; the fastest, " << block_text(model, b) << ", at "
             << c.speed[b] << " m/s in the mean of " << c.window << " s, where joints give " << c.give << " m";
    } else if (!loads_are_on) {
        text << "the loading still changes";
    } else if (c.rested[b] > 0) {
        text << "at rest, but not yet for long enough";
    } else {
        text << "still moves, and is not seen to go on or to come to rest: " << motion_text(model, state, b);
    }
    return text.str();
}

}  // namespace

StabilityVerdict conclude(const Model& model, const State& state, bool loads_are_on) {
    StabilityVerdict v = begin(model, state);
    const Course& c = state.course;
    if (c.window == 0.0) {
        v.reason = "the run ended before displacements counted";
        return v;
    }
    Footing footing;
    footing.find(model, state);
    bool unstable = false;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (c.mechanism[b] != Mechanism::none)
            v.block_mechanism[b] = c.mechanism[b];
        else if (loads_are_on && free_to_move(model, state, b) && goes_on(state, b))
            v.block_mechanism[b] = mechanism_of(model, state, footing, b);
        unstable |= v.block_mechanism[b] != Mechanism::none;
    }
    for (BlockId b = 0; unstable && b < model.blocks.size(); ++b)
        if (v.block_mechanism[b] == Mechanism::none && free_to_move(model, state, b) && moves(model, state, b))
            v.block_mechanism[b] = mechanism_of(model, state, footing, b);
    count(model, state, v);
    v.verdict = unstable                                              ? Stability::unstable
                : loads_are_on && all_stand(model, state, at_the_end) ? Stability::stable
                                                                      : Stability::undecided;
    if (c.verdict == v.verdict && c.verdict != Stability::undecided) v.time = c.certain_at;
    v.kinetic_energy_trend = ratio(c.kinetic_last, c.kinetic_before);
    if (const BlockId b = fastest(model, state, false, v); b >= 0)
        v.displacement_trend = ratio(c.speed[b], c.speed_before[b]);
    v.reason = reason(model, state, loads_are_on, v);
    return v;
}

StabilityVerdict conclude_static(const Model& model, const State& state) {
    StabilityVerdict v = begin(model, state);
    const StaticEvidence& now = state.statics.now;
    v.unbalanced_ratio = now.ratio;
    std::ostringstream text;
    text.precision(3);
    if (now.reached) {
        v.verdict = Stability::stable;
        text << "equilibrium: unbalanced ratio " << now.ratio << ", drift " << now.drift;
    } else if (now.moving < 0) {
        text << "no equilibrium within " << now.iterations << " iterations: unbalanced ratio " << now.ratio;
    } else {
        v.verdict = Stability::unstable;
        Footing footing;
        footing.find(model, state);
        const double farthest = way_gone(model, state, now.moving);
        for (BlockId b = 0; b < model.blocks.size(); ++b)
            if (free_to_move(model, state, b) && way_gone(model, state, b) > takes_along * farthest)
                v.block_mechanism[b] = mechanism_seen_now(model, state, footing, b);
        count(model, state, v);
        text << "there is no equilibrium: " << block_text(model, now.moving) << " keeps moving, unbalanced ratio "
             << now.ratio;
    }
    v.reason = text.str();
    return v;
}

}  // namespace talus
