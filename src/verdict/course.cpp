#include "verdict/course.hpp"

#include "model/measure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace talus {
namespace {

constexpr int looks_in_window = 32;

// Of the size of a block. When it has moved so far, one sees how it sets out: whether what carries it slips. Later it may do
// what it did not at first: a block that topples begins to slip as it turns. By half of it the mode changes by less than a
// tenth of a degree of friction.
constexpr double visible = 0.005;
constexpr double beyond_give = 20.0;  // times what springs account for: so much is no elastic motion
constexpr double at_rest = 4.0;       // times the same, from window to window: no motion at all
constexpr double resolved = 1e-6;     // of its size: the same, where nothing gives

// Of the way, for the slip and for the turn of the farthest corner: less is none. The least of both that a single block on a
// plane has 0.3 degrees of friction from where its mode changes is 0.05, so half of it would not be sharper, and twice as
// much be wrong there; in a mass that moves, blocks that slide turn by a few hundredths of their way.
constexpr double a_part = 0.05;

constexpr double no_slower = 0.95;  // than in the window before
constexpr int gathers_speed = 2;    // windows in a row, beyond which a block that has gone far goes on
constexpr int long_lasting =
    8;  // windows in a row, beyond which it does so wherever it is: half of it would take slow swings for it
// Windows in a row at rest: twice as many find four times smaller accelerations.
constexpr double rests = 4.0;
// Windows in a row in which a block comes no further, though it does not rest: half of it would be one swing of a block that
// rocks.
constexpr double swings = 8.0;
constexpr double free_fall = 0.9;  // of gravity

double size_of(const Model& model, BlockId b) { return std::sqrt(model.blocks.area[b]); }

double gravity(const Model& model, const State& state) {
    return std::hypot(model.gravity_x(state.stage_time), model.gravity_y(state.stage_time));
}

double mean_size(const Model& model, const State& state) {
    double area = 0.0;
    int blocks = 0;
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        if (free_to_move(model, state, b)) area += model.blocks.area[b], ++blocks;
    return blocks > 0 ? std::sqrt(area / blocks) : 1.0;
}

double turned(const Model& model, const State& state, BlockId b) {
    return model.blocks.radius[b] * std::abs(state.motion.angle[b] - state.start_angle[b]);
}

// rad, by which a block that rocks on its narrow side turns at most: from one corner to over the other.
double rocking_angle(const Model& model, BlockId b) {
    double width = 0.0;
    for (PartId p = model.blocks.first_part[b]; p < model.blocks.first_part[b + 1]; ++p)
        width = std::max(width, model.parts.thickness[p]);
    return std::asin(std::min(1.0, 0.5 * width / model.blocks.radius[b]));
}

// Further than a block can rock to and fro: beyond its own size, or turned past its corner.
bool is_far(const Model& model, const State& state, BlockId b) {
    const double way = way_gone(model, state, b), turn = turned(model, state, b);
    return way >= size_of(model, b) || (turn > a_part * way && turn >= model.blocks.radius[b] * rocking_angle(model, b));
}

// Nothing carries it: it gains the speed of free fall, but for what local damping takes. Without gravity: nothing touches
// it.
bool falls(const Model& model, const State& state, const Footing& footing, BlockId b) {
    const Vec2 g(model.gravity_x(state.stage_time), model.gravity_y(state.stage_time));
    if (g.isZero()) return !footing.carried(b);
    return state.course.gained[b].dot(g) >= free_fall * (1.0 - model.local_damping) * g.squaredNorm();
}

bool slips(const Model& model, const State& state, const Footing& footing, BlockId b) {
    return footing.slip(model, state, b) > a_part * way_gone(model, state, b);
}

Mechanism on_its_footing(const Model& model, const State& state, BlockId b, bool with_slip) {
    if (turned(model, state, b) <= a_part * way_gone(model, state, b)) return Mechanism::slide;
    return with_slip ? Mechanism::slide_and_topple : Mechanism::topple;
}

double rest_of(const Model& model, const Course& course, BlockId b) {
    return std::max(at_rest * course.give, resolved * size_of(model, b));
}

/// What joints have closed: the most of one contact, and the mean settlement of all blocks. The springs of a scene under its
/// weight hold E = (1/2) sum of m g u, u being how far each block has come down.
struct Closure {
    double most = 0.0, settlement = 0.0;  // m
};

Closure closure(const Model& model, const State& state) {
    Closure found;
    double energy = 0.0, weight = 0.0;
    for (const Contact& c : state.contacts.list) {
        if (!c.touching || c.length <= 0.0) continue;
        found.most = std::max({found.most, c.overlap, std::abs(c.shear_force) / (model.joints[c.joint].ks * c.length)});
        energy += 0.5 * c.normal_force * std::max(c.overlap, 0.0) + c.shear_energy;
    }
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        if (free_to_move(model, state, b)) weight += model.blocks.mass[b] * gravity(model, state);
    found.settlement = weight > 0.0 ? 2.0 * energy / weight : 0.0;
    return found;
}

struct Span {
    double span;   // s, between the means of the last two windows
    double since;  // s, between the times of the velocities
};

std::uint8_t one_more(std::uint8_t count) { return static_cast<std::uint8_t>(std::min(count + 1, 255)); }

/// Takes the mean of the window that ends.
void follow(const Model& model, const Span& time, bool loads_are_on, BlockId b, State& state) {
    Course& c = state.course;
    const Vec2 mean = c.sum[b] / static_cast<double>(c.looks), velocity = (mean - c.mean[b]) / time.span;
    const double turn = c.turn_sum[b] / static_cast<double>(c.looks);
    const double speed = velocity.norm() + model.blocks.radius[b] * std::abs(turn - c.turn_mean[b]) / time.span;
    const double rest = rest_of(model, c, b), way = std::max(mean.norm(), model.blocks.radius[b] * std::abs(turn));
    const bool moved = speed * time.span > rest;
    const bool onward = moved && speed >= no_slower * c.speed[b] && velocity.dot(c.velocity[b]) >= 0.0;
    c.going[b] = onward ? one_more(c.going[b]) : std::uint8_t{0};
    c.rested[b] = loads_are_on && !moved ? one_more(c.rested[b]) : std::uint8_t{0};
    c.no_further[b] = loads_are_on && way <= c.reach[b] + rest ? one_more(c.no_further[b]) : std::uint8_t{0};
    c.reach[b] = std::max(c.reach[b], way);
    c.gained[b] = (velocity - c.velocity[b]) / time.since;
    c.speed_before[b] = c.speed[b];
    c.speed[b] = speed;
    c.velocity[b] = velocity;
    c.mean[b] = mean;
    c.turn_mean[b] = turn;
}

// While loads change, what has gone may come back, or stop: only what is further away than its own size is gone for good.
bool is_certain(const Model& model, bool loads_are_on, const State& state, BlockId b) {
    const Course& c = state.course;
    if (c.set_out[b] == SetOut::not_yet || c.going[b] == 0) return false;
    if (!loads_are_on) return way_gone(model, state, b) >= size_of(model, b);
    return c.going[b] >= long_lasting || (c.going[b] >= gathers_speed && is_far(model, state, b));
}

void begin_window(const Model& model, const Circumstances& now, State& state) {
    Course& c = state.course;
    const double g = std::max(gravity(model, state), 1.0);
    const Closure closed = now.springs ? closure(model, state) : Closure{};
    // In this time a block falls by half of its size; a mass that settles by u swings with 2 pi sqrt(u/g). In half of it one
    // would take a swing for a way, in twice of it one sees the same later.
    const double fall = std::sqrt(mean_size(model, state) / g),
                 swing = 2.0 * std::numbers::pi * std::sqrt(closed.settlement / g);
    c.window = std::max(fall, swing);
    c.give = now.springs ? std::max(closed.most, closed.settlement) : now.creep * c.window;
    c.window_begin = state.time;
    c.next_look = state.time + c.window / looks_in_window;
    c.looks = 0;
    c.kinetic = 0.0;
    std::ranges::fill(c.sum, Vec2::Zero());
    std::ranges::fill(c.turn_sum, 0.0);
}

}  // namespace

bool free_to_move(const Model& model, const State& state, BlockId b) {
    if (state.removed[b] || model.blocks.held(b)) return false;
    return std::ranges::none_of(model.driven, [b](const DrivenBlock& d) { return d.block == b; });
}

void begin_course(const Model& model, const Circumstances& now, State& state) {
    const int nb = model.blocks.size();
    Course& c = state.course;
    c.kinetic_last = c.kinetic_before = 0.0;
    c.sum.resize(nb);
    c.turn_sum.resize(nb);
    c.mean.resize(nb);
    c.turn_mean.resize(nb);
    for (BlockId b = 0; b < nb; ++b) {
        c.mean[b] = state.motion.position[b] - state.start_position[b];
        c.turn_mean[b] = state.motion.angle[b] - state.start_angle[b];
    }
    c.velocity_time = c.mean_time = state.time;
    c.velocity = state.motion.velocity;
    c.gained.assign(nb, Vec2::Zero());
    c.speed.resize(nb);
    for (BlockId b = 0; b < nb; ++b)
        c.speed[b] = state.motion.velocity[b].norm() + model.blocks.radius[b] * std::abs(state.motion.spin[b]);
    c.speed_before.assign(nb, 0.0);
    c.going.assign(nb, 0);
    c.rested.assign(nb, 0);
    c.no_further.assign(nb, 0);
    c.reach.resize(nb);
    for (BlockId b = 0; b < nb; ++b) c.reach[b] = way_gone(model, state, b);
    c.set_out.resize(nb, SetOut::not_yet);
    c.mechanism.resize(nb, Mechanism::none);
    begin_window(model, now, state);
}

bool take_look(const Model& model, Footing& footing, State& state) {
    Course& c = state.course;
    bool found = false;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        c.sum[b] += state.motion.position[b] - state.start_position[b];
        c.turn_sum[b] += state.motion.angle[b] - state.start_angle[b];
        if (c.set_out[b] != SetOut::not_yet || model.blocks.held(b) || state.removed[b]) continue;
        const double way = way_gone(model, state, b);
        if (way < std::max(visible * size_of(model, b), beyond_give * c.give)) continue;
        if (!found) footing.find(model, state);
        found = true;
        c.set_out[b] = slips(model, state, footing, b) ? SetOut::with_slip : SetOut::without_slip;
    }
    c.kinetic += kinetic_energy(model, state);
    ++c.looks;
    c.next_look = c.window_begin + (static_cast<double>(c.looks) + 1.0) * c.window / looks_in_window;
    return state.time >= c.window_begin + c.window * (1.0 - 1e-9);
}

Mechanism mechanism_of(const Model& model, const State& state, const Footing& footing, BlockId b) {
    if (falls(model, state, footing, b)) return Mechanism::fall;
    return on_its_footing(model, state, b, state.course.set_out[b] == SetOut::with_slip);
}

Mechanism mechanism_seen_now(const Model& model, const State& state, const Footing& footing, BlockId b) {
    if (!footing.carried(b)) return Mechanism::fall;
    return on_its_footing(model, state, b, slips(model, state, footing, b));
}

bool goes_on(const State& state, BlockId b) {
    const Course& c = state.course;
    return c.set_out[b] != SetOut::not_yet && c.going[b] >= gathers_speed;
}

bool moves(const Model& model, const State& state, BlockId b) {
    const Course& c = state.course;
    if (c.set_out[b] == SetOut::not_yet) return false;
    return c.speed[b] * c.window > visible * size_of(model, b) || way_gone(model, state, b) > size_of(model, b);
}

bool all_stand(const Model& model, const State& state, double share) {
    const Course& c = state.course;
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        if (free_to_move(model, state, b) && c.rested[b] < share * rests && c.no_further[b] < share * swings) return false;
    return true;
}

void close_window(const Model& model, const Circumstances& now, Footing& footing, State& state) {
    Course& c = state.course;
    footing.find(model, state);
    // From the start of a stage to the mean of its first window: x = v t + a t^2/2 has the mean v T/2 + a T^2/6, T/2 after
    // the start, which is the velocity at T/3.
    const double middle = 0.5 * (c.window_begin + state.time);
    const bool first = c.mean_time == c.window_begin;
    const double velocity_time = first ? c.window_begin + (state.time - c.window_begin) / 3.0 : 0.5 * (c.mean_time + middle);
    const Span time{middle - c.mean_time, velocity_time - c.velocity_time};
    double known = 0.0, seems = 0.0;  // m2, of blocks that are known to be on their way, and of those that seem to be
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (!free_to_move(model, state, b)) continue;
        follow(model, time, now.loads_are_on, b, state);
        if (c.mechanism[b] == Mechanism::none && is_certain(model, now.loads_are_on, state, b))
            c.mechanism[b] = mechanism_of(model, state, footing, b);
        if (c.mechanism[b] != Mechanism::none)
            known += model.blocks.area[b];
        else if (goes_on(state, b))
            seems += model.blocks.area[b];
    }
    c.mean_time = middle;
    c.velocity_time = velocity_time;
    c.kinetic_before = c.kinetic_last;
    c.kinetic_last = c.kinetic / static_cast<double>(c.looks);
    const Stability seen = known > 0.0 && known >= seems                  ? Stability::unstable
                           : known == 0.0 && all_stand(model, state, 1.0) ? Stability::stable
                                                                          : c.verdict;
    if (now.loads_are_on && seen != c.verdict && c.verdict != Stability::unstable) {
        c.verdict = seen;
        c.certain_at = state.time;
    }
    begin_window(model, now, state);
}

}  // namespace talus
