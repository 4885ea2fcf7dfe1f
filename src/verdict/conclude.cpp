#include "verdict/conclude.hpp"

#include "core/text.hpp"
#include "model/measure.hpp"
#include "model/title.hpp"
#include "verdict/course.hpp"
#include "verdict/mechanism.hpp"
#include "verdict/way.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace talus {
namespace {

constexpr double at_the_end = 0.5;  // of the windows that are waited for when a run may end before its time
// Of the way of the block that goes farthest in a static stage: it takes along what moves with it, and leaves behind what
// only gives.
constexpr double takes_along = 0.25;

double ratio(double now, double before) { return before > 0.0 ? now / before : 0.0; }

void count(const Model& model, const State& state, StabilityVerdict& v) {
    std::vector<std::uint8_t> touched(model.blocks.size(), 0);
    for (const Contact& c : state.contacts.list)
        if (c.touching) touched[model.parts.block[c.part_a]] = touched[model.parts.block[c.part_b]] = 1;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (v.block_mechanism[b] == Mechanism::none) continue;
        ++v.moving_blocks;
        v.moving_area += model.blocks.area[b];
        v.detached_blocks += !touched[b];
    }
    v.moving_share = ratio(v.moving_area, free_area(model, state));
    if (v.verdict == Stability::unstable) v.mechanism = mechanism_of_the_mass(model, state, v.block_mechanism);
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
    text << title_and_place(model, b) << " has gone " << way << " m, " << way / std::sqrt(model.blocks.area[b])
         << " of its size, at " << c.speed[b] << " m/s in the mean of the last " << c.window << " s and "
         << c.speed_before[b] << " m/s before";
    return text.str();
}

// Of a scene that stands now, the way that it needed for that, if one sees it.
std::string rest_text(const Model& model, const State& state) {
    BlockId farthest = -1;
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        if (state.course.set_out[b] != SetOut::not_yet &&
            (farthest < 0 || way_gone(model, state, b) > way_gone(model, state, farthest)))
            farthest = b;
    if (farthest < 0) return "";
    std::ostringstream text;
    text.precision(3);
    text << "; " << title_and_place(model, farthest) << " came to rest " << way_gone(model, state, farthest) << " m away";
    return text.str();
}

std::string share_text(const StabilityVerdict& v) {
    std::ostringstream text;
    text.precision(3);
    text << v.moving_blocks << (v.moving_blocks == 1 ? " block" : " blocks") << ", " << 100.0 * v.moving_share
         << " % of the area that is free";
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
    } else if (v.verdict == Stability::stable && v.moving_blocks > 0) {
        text << "less than a failure comes loose: " << share_text(v) << "; all others rest, or come no further";
    } else if (v.verdict == Stability::stable) {
        text << "all blocks that are free rest, or come no further; the fastest, " << title_and_place(model, b) << ", at "
             << c.speed[b] << " m/s in the mean of " << c.window << " s, where joints give " << c.give << " m"
             << rest_text(model, state);
    } else if (!loads_are_on) {
        text << "the loading still changes";
    } else if (c.rested[b] > 0) {
        text << "at rest, but not yet for long enough";
    } else {
        text << "still moves, and is not seen to go on or to come to rest: " << motion_text(model, state, b);
    }
    return text.str();
}

// rad: what comes to rest after so large a turn lies on another face. Half of it is met by blocks that lean, twice of it
// misses a square that falls off its tip.
constexpr double fallen_over = 0.4;

/// Blocks of a static stage that have come to rest further away than they can rock, or on another face, or went along with
/// one that keeps moving.
void find_moved(const Model& model, const State& state, StabilityVerdict& v) {
    const StaticEvidence& now = state.statics.now;
    const double farthest = now.moving < 0 ? 0.0 : way_gone(model, state, now.moving);
    Footing footing;
    footing.find(model, state);
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (!free_to_move(model, state, b)) continue;
        const bool went_along = now.moving >= 0 && way_gone(model, state, b) > takes_along * farthest;
        const bool fell_over = std::abs(state.motion.angle[b] - state.start_angle[b]) >= fallen_over;
        if (went_along || fell_over || is_far(model, state, b))
            v.block_mechanism[b] = mechanism_seen_now(model, state, footing, b);
    }
}

}  // namespace

StabilityVerdict conclude(const Model& model, const State& state, const Circumstances& now) {
    StabilityVerdict v = begin(model, state);
    const Course& c = state.course;
    if (c.window == 0.0) {
        v.reason = "the run ended before displacements counted";
        return v;
    }
    const double smallest = now.smallest_failure * free_area(model, state);
    Footing footing;
    footing.find(model, state);
    double area = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (c.mechanism[b] != Mechanism::none)
            v.block_mechanism[b] = c.mechanism[b];
        else if (now.loads_are_on && free_to_move(model, state, b) && goes_on(state, b))
            v.block_mechanism[b] = mechanism_of(model, state, footing, b);
        if (v.block_mechanism[b] != Mechanism::none) area += model.blocks.area[b];
    }
    const bool unstable = is_failure(area, smallest);
    for (BlockId b = 0; unstable && b < model.blocks.size(); ++b)
        if (v.block_mechanism[b] == Mechanism::none && free_to_move(model, state, b) && moves(model, state, b))
            v.block_mechanism[b] = mechanism_of(model, state, footing, b);
    v.verdict = unstable                                                                             ? Stability::unstable
                : now.loads_are_on && !is_failure(restless_area(model, state, at_the_end), smallest) ? Stability::stable
                                                                                                     : Stability::undecided;
    count(model, state, v);
    if (c.verdict == v.verdict && c.verdict != Stability::undecided) v.time = c.certain_at;
    v.kinetic_energy_trend = ratio(c.kinetic_last, c.kinetic_before);
    if (const BlockId b = fastest(model, state, false, v); b >= 0)
        v.displacement_trend = ratio(c.speed[b], c.speed_before[b]);
    v.reason = reason(model, state, now.loads_are_on, v);
    return v;
}

StabilityVerdict conclude_static(const Model& model, const State& state, const Circumstances& now) {
    StabilityVerdict v = begin(model, state);
    const StaticEvidence& found = state.statics.now;
    v.unbalanced_ratio = found.ratio;
    find_moved(model, state, v);
    double area = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        if (v.block_mechanism[b] != Mechanism::none) area += model.blocks.area[b];
    v.verdict = is_failure(area, now.smallest_failure * free_area(model, state)) ? Stability::unstable
                : found.reached                                                  ? Stability::stable
                                                                                 : Stability::undecided;
    count(model, state, v);
    std::ostringstream text;
    text.precision(3);
    if (found.reached && v.moving_blocks > 0)
        text << "equilibrium, unbalanced ratio " << found.ratio << ", after " << share_text(v) << ", has come down";
    else if (found.reached)
        text << "equilibrium: unbalanced ratio " << found.ratio << ", drift " << found.drift;
    else if (found.moving < 0)
        text << "no equilibrium within " << found.iterations << " iterations: unbalanced ratio " << found.ratio;
    else
        text << "there is no equilibrium: " << title_and_place(model, found.moving) << " keeps moving, unbalanced ratio "
             << found.ratio;
    v.reason = text.str();
    return v;
}

}  // namespace talus
