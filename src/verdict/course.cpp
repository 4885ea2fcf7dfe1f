#include "verdict/course.hpp"

#include "model/measure.hpp"
#include "verdict/mechanism.hpp"
#include "verdict/way.hpp"

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
constexpr double resolved = 1e-6;     // of its size: no motion at all, where nothing gives

constexpr double no_slower = 0.95;  // than in the window before
constexpr int gathers_speed = 2;    // windows in a row, beyond which a block that has gone far goes on
constexpr int long_lasting =
    8;  // windows in a row, beyond which it does so wherever it is: half of it would take slow swings for it
// Windows in a row at rest: twice as many find four times smaller accelerations.
constexpr double rests = 4.0;
// Windows in a row in which a block comes no further, though it does not rest: half of it would be one swing of a block that
// rocks.
constexpr double swings = 8.0;
// Times its size: what loses hold of its neighbours before it has gone so far falls, though it slid out from between them. A
// block as high as four times its width slides by twice its size until it has come out; beyond that it has slid off.
constexpr double slides_out = 2.0;
// Of the way, by turning. Of a block that turns about its toe it is all, of one that falls and spins it is less.
constexpr double mainly = 0.25;

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

// m, in a window: no motion. Where joints give much, a block that goes visibly is on its way all the same.
double rest_of(const Model& model, const Course& course, BlockId b) {
    return std::clamp(no_motion * course.give, resolved * size_of(model, b), visible * size_of(model, b));
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

std::uint8_t one_more(std::uint8_t count) { return static_cast<std::uint8_t>(std::min(count + 1, 255)); }

/// Takes the mean of the window that ends, `span` (s) after that of the window before.
void follow(const Model& model, double span, bool loads_are_on, BlockId b, State& state) {
    Course& c = state.course;
    const Vec2 mean = c.sum[b] / static_cast<double>(c.looks), velocity = (mean - c.mean[b]) / span;
    const double turn = c.turn_sum[b] / static_cast<double>(c.looks);
    const double speed = velocity.norm() + turning_way(model, b, turn - c.turn_mean[b]) / span;
    const double rest = rest_of(model, c, b), way = std::max(mean.norm(), turning_way(model, b, turn));
    const bool moved = speed * span > rest;
    const bool onward = moved && speed >= no_slower * c.speed[b] && velocity.dot(c.velocity[b]) >= 0.0;
    c.going[b] = onward ? one_more(c.going[b]) : std::uint8_t{0};
    c.rested[b] = loads_are_on && !moved ? one_more(c.rested[b]) : std::uint8_t{0};
    c.no_further[b] = loads_are_on && way <= c.reach[b] + rest ? one_more(c.no_further[b]) : std::uint8_t{0};
    c.reach[b] = std::max(c.reach[b], way);
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

double mean_way(const Model& model, const Course& c, BlockId b) {  // m, in the window before
    return std::max(c.mean[b].norm(), turning_way(model, b, c.turn_mean[b]));
}

/// Whether it had set out by turning, in the window before: a block that topples on a steep slope takes off, and is no block
/// that falls.
bool had_turned(const Model& model, const Course& c, BlockId b) {
    const double way = mean_way(model, c, b);
    return way > visible * size_of(model, b) && turning_way(model, b, c.turn_mean[b]) > mainly * way;
}

/// Whether the block fell in the window that ends. What slid, and fell before it had gone far, has fallen.
void judge(const Model& model, const Footing& footing, BlockId b, State& state) {
    Course& c = state.course;
    const bool let_go = mean_way(model, c, b) < slides_out * size_of(model, b) && !had_turned(model, c, b);
    c.fell[b] = (c.fell[b] || let_go) && fell_freely(model, state, footing, b);
    if (c.fell[b] && c.mechanism[b] != Mechanism::none) c.mechanism[b] = Mechanism::fall;
}

/// Nothing carries it just now: whether it falls, or lands on what it slides on, the next window shows.
bool is_letting_go(const Model& model, const State& state, const Footing& footing, BlockId b) {
    const Course& c = state.course;
    return !footing.carried(b) && !c.fell[b] && !had_turned(model, c, b) &&
           way_gone(model, state, b) < slides_out * size_of(model, b);
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
    c.velocity_begin = state.motion.velocity;
    c.give = now.springs ? std::max(closed.most, closed.settlement) : now.creep * c.window;
    c.window_begin = state.time;
    c.next_look = state.time + c.window / looks_in_window;
    c.looks = 0;
    c.kinetic = 0.0;
    std::ranges::fill(c.sum, Vec2::Zero());
    std::ranges::fill(c.turn_sum, 0.0);
}

}  // namespace

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
    c.mean_time = state.time;
    c.velocity = state.motion.velocity;
    c.fell.assign(nb, 0);
    c.speed.resize(nb);
    for (BlockId b = 0; b < nb; ++b)
        c.speed[b] = state.motion.velocity[b].norm() + turning_way(model, b, state.motion.spin[b]);
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

bool goes_on(const State& state, BlockId b) {
    const Course& c = state.course;
    return c.set_out[b] != SetOut::not_yet && c.going[b] >= gathers_speed;
}

bool moves(const Model& model, const State& state, BlockId b) {
    const Course& c = state.course;
    if (c.set_out[b] == SetOut::not_yet) return false;
    return c.speed[b] * c.window > visible * size_of(model, b) || way_gone(model, state, b) > size_of(model, b);
}

bool is_failure(double area, double smallest) { return area > 0.0 && area >= smallest; }

double restless_area(const Model& model, const State& state, double share) {
    const Course& c = state.course;
    double area = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (!free_to_move(model, state, b)) continue;
        const bool stands = c.rested[b] >= share * rests || c.no_further[b] >= share * swings;
        if (!stands || c.mechanism[b] != Mechanism::none) area += model.blocks.area[b];
    }
    return area;
}

void close_window(const Model& model, const Circumstances& now, Footing& footing, State& state) {
    Course& c = state.course;
    footing.find(model, state);
    const double middle = 0.5 * (c.window_begin + state.time), span = middle - c.mean_time;
    double known = 0.0, seems = 0.0;  // m2, of blocks that are known to be on their way, and of those that seem to be
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (!free_to_move(model, state, b)) continue;
        judge(model, footing, b, state);
        follow(model, span, now.loads_are_on, b, state);
        if (c.mechanism[b] == Mechanism::none && is_certain(model, now.loads_are_on, state, b) &&
            !is_letting_go(model, state, footing, b))
            c.mechanism[b] = mechanism_of(model, state, footing, b);
        if (c.mechanism[b] != Mechanism::none)
            known += model.blocks.area[b];
        else if (goes_on(state, b))
            seems += model.blocks.area[b];
    }
    c.mean_time = middle;
    c.kinetic_before = c.kinetic_last;
    c.kinetic_last = c.kinetic / static_cast<double>(c.looks);
    const double smallest = now.smallest_failure * free_area(model, state);
    const Stability seen = is_failure(known, smallest) && known >= seems             ? Stability::unstable
                           : !is_failure(restless_area(model, state, 1.0), smallest) ? Stability::stable
                                                                                     : c.verdict;
    if (now.loads_are_on && seen != c.verdict && c.verdict != Stability::unstable) {
        c.verdict = seen;
        c.certain_at = state.time;
    }
    begin_window(model, now, state);
}

}  // namespace talus
