#include "statics/static_solver.hpp"

#include "model/measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace {

constexpr int look_interval = 5;          // iterations between looks at the unbalanced ratio, which cost a tenth of one
constexpr int least_iterations = 10;      // before a state is called an equilibrium: one may pass through balance
constexpr double least_share = 1e-3;      // where it comes on slowest
constexpr double first_share = 0.01;      // of the load in the first iteration
constexpr double rounding = 1e-13;        // unbalanced ratio below which there is nothing to gain
constexpr double spare = 1e-3;            // of the tolerance: below, Newton's method stops; it costs a step or two
constexpr std::int64_t patience = 50;     // iterations of relaxation after Newton has failed first; doubled each time
constexpr double push_growth = 10.0;      // of a push off an equilibrium that is unstable, where the one before led back
constexpr std::int64_t first_look = 200;  // iterations to the first look whether something keeps moving; doubled then
constexpr double far = 0.01;              // of its size: if it has so far to go, it is not held
constexpr int looks_needed = 3;           // without progress: 1600 iterations at least
constexpr int fall_interval = 200;        // iterations between looks whether something has left its place altogether
// Sizes of a block: what has gone so far and is still moving was held by nothing. Joints that close and gaps that shut are a
// tenth of it at most; twice of it finds the same blocks some hundred iterations later.
constexpr double left_its_place = 3.0;

double quarter_of_thinnest(const Model& model, const State& state) {
    double thinnest = std::numeric_limits<double>::infinity();
    for (PartId p = 0; p < model.parts.size(); ++p)
        if (!state.removed[model.parts.block[p]]) thinnest = std::min(thinnest, model.parts.thickness[p]);
    return 0.25 * thinnest;
}

void add(double share, const std::vector<Force>& what, std::vector<Force>& to) {
    const int nb = static_cast<int>(to.size());
#pragma omp parallel for schedule(static)
    for (int b = 0; b < nb; ++b) {
        to[b].force += share * what[b].force;
        to[b].torque += share * what[b].torque;
    }
}

// Out of balance, as a share of what the load has done so far.
double lag(const Model& model, const Unbalance& now, const Statics& statics) {
    double coming = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        coming = std::max(coming, out_of_balance(model.blocks, b, statics.held_back[b]));
    return now.largest / std::max(std::abs(now.pressed - statics.pressed), coming);
}

// Largest displacement in one iteration in sizes of the block.
double largest_share(const Model& model, const Motion& motion) {
    double largest = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        largest = std::max(largest, (motion.velocity[b].norm() + std::abs(motion.spin[b]) * model.blocks.radius[b]) /
                                        std::sqrt(model.blocks.area[b]));
    return largest;
}

}  // namespace

void hold_back(const Statics& statics, std::vector<Force>& load) {
    if (statics.load_share < 1.0) add(statics.load_share - 1.0, statics.held_back, load);
}

StaticSolver::StaticSolver(const Model& model, State& state)
    : mass_(model, state.removed), longest_(quarter_of_thinnest(model, state)) {
    if (!state.statics.angle.empty()) mass_.turn_to(state.statics.angle);
}

void StaticSolver::begin(const Model& model, double tolerance, State& state) {
    Statics& s = state.statics;
    if (s.now.iterations > 0) s.earlier.push_back(s.now);
    s.now = {.stage = state.stage};
    const Unbalance before = unbalance(model, state);
    s.now.ratio = before.ratio();
    s.held_back = state.load;
    s.load_share = s.now.ratio > tolerance ? 0.0 : 1.0;
    s.load_rate = first_share;
    s.load_lag = 0.0;
    s.pressed = before.pressed;
    s.shift = 1e-6;
    s.push = 1.0;
    s.polish_at = least_iterations;
    s.patience = patience;
    s.start = state.motion.position;
    s.look_at = first_look;
    s.look_share = s.look_distance = 0.0;
    s.look_ratio = std::numeric_limits<double>::infinity();
    s.suspicious = 0;
    hold_back(s, state.load);
    start_relaxation(mass_, state);
}

void StaticSolver::iterate(const Model& model, const Placed& placed, double tolerance, const Forces& forces, State& state) {
    Statics& s = state.statics;
    ++s.now.iterations;
    if (s.load_share < 1.0) bring_on_load(state);
    const bool near =
        s.load_share == 1.0 && s.now.ratio < std::max(polish_ratio, tolerance) && s.now.iterations >= s.polish_at;
    if (near && polish(model, placed, tolerance, forces, state)) return;
    relax(model, mass_, longest_, forces, state);
    if (s.now.iterations % look_interval == 0) look(model, tolerance, state);
}

void StaticSolver::bring_on_load(State& state) const {
    Statics& s = state.statics;
    const double more =
        s.load_lag > 2.0 * path_ratio && s.now.increments > 0 ? 0.0 : std::min(s.load_rate, 1.0 - s.load_share);
    if (more == 0.0) return;
    add(more, s.held_back, state.load);
    add(more, s.held_back, s.load);  // the damping is measured by what the blocks answer, not by the load
    s.load_share += more;
    if (s.load_share > 1.0 - 1e-12) s.load_share = 1.0;
    ++s.now.increments;
}

// One step of Newton's method; false if it did not help.
bool StaticSolver::polish(const Model& model, const Placed& placed, double tolerance, const Forces& forces, State& state) {
    Statics& s = state.statics;
    const double before = s.now.ratio;
    if (!newton_.improve(model, mass_, placed, longest_, forces, state)) {
        s.polish_at = s.now.iterations + s.patience;
        s.patience *= 2;
        if (s.now.ratio < tolerance && s.now.drift < largest_drift) settle(model, placed, forces, state);
        start_relaxation(mass_, state);
        return s.now.reached != 0;
    }
    ++s.now.newton_steps;
    s.now.ratio = unbalanced_ratio(model, state);
    s.now.drift = largest_share(model, state.motion);
    s.newton_ratios.push_back(s.now.ratio);
    const bool more_to_gain = s.now.ratio > std::max(rounding, spare * tolerance) && s.now.ratio < 0.25 * before;
    if (s.now.ratio < tolerance && s.now.drift < largest_drift && !more_to_gain) settle(model, placed, forces, state);
    start_relaxation(mass_, state);
    return true;
}

// The end, unless nothing stays here: then what moves next is pushed, and relaxation shows where it goes.
void StaticSolver::settle(const Model& model, const Placed& placed, const Forces& forces, State& state) {
    Statics& s = state.statics;
    Motion way;
    if (!newton_.unstable(model, mass_, placed, forces, state, way)) {
        s.now.reached = 1;
        return;
    }
    move(std::min(s.push, longest_ / largest_rate(model, way)), way, state.motion);
    forces.evaluate();
    s.now.ratio = unbalanced_ratio(model, state);
    s.push *= push_growth;
    s.polish_at = s.now.iterations + s.patience;
    s.patience *= 2;
}

void StaticSolver::look(const Model& model, double tolerance, State& state) const {
    Statics& s = state.statics;
    const Unbalance now = unbalance(model, state);
    s.now.ratio = now.ratio();
    if (s.load_share < 1.0) {
        s.now.loading_ratio = std::max(s.now.loading_ratio, s.now.ratio);
        s.load_lag = lag(model, now, s);
        s.load_rate = s.load_lag > path_ratio ? std::max(0.5 * s.load_rate, least_share) : 1.25 * s.load_rate;
    }
    const double time = s.damping > 0.0 ? 2.0 / s.damping : static_cast<double>(s.now.iterations);
    s.now.drift = time * largest_share(model, state.motion);
    // Newton's method has the last word: it helps, or there is nothing left to gain.
    if (s.now.ratio < tolerance && s.now.drift < largest_drift)
        s.polish_at = std::max<std::int64_t>(s.now.iterations, least_iterations);
    if (s.now.iterations % fall_interval == 0) look_for_fall(model, state);
    if (s.now.iterations >= s.look_at) look_for_motion(model, state);
}

// A heap of falling blocks hits and wakes others for as long as it falls, so its way need not double from look to look.
void StaticSolver::look_for_fall(const Model& model, State& state) const {
    double farthest = left_its_place;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (state.removed[b]) continue;
        const double size = std::sqrt(model.blocks.area[b]);
        const double gone = (state.motion.position[b] - state.statics.start[b]).norm() / size;
        if (gone > farthest && way_ahead(b, state) > far * size) farthest = gone, state.statics.now.moving = b;
    }
}

// m, from the stiffness that the last window met: infinite where there was none. A soft arch or a block that almost topples
// takes thousands of iterations to come to rest, and its displacement doubles with the iterations for long.
double StaticSolver::way_ahead(BlockId b, const State& state) const {
    const double w0 = 0.5 * state.statics.damping;
    if (w0 == 0.0) return std::numeric_limits<double>::infinity();
    const Eigen::Vector3d a = mass_.inverse(b) * components(state.load[b]);
    return state.motion.velocity[b].norm() / w0 + a.head<2>().norm() / (w0 * w0);
}

// A block that nothing holds gathers speed, or slides on at one speed, while what is out of balance stays: twice the
// iterations take it twice as far. What comes to rest does not.
void StaticSolver::look_for_motion(const Model& model, State& state) const {
    Statics& s = state.statics;
    BlockId farthest = -1;
    double distance = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (state.removed[b]) continue;
        const double here = (state.motion.position[b] - s.start[b]).norm();
        if (here > distance) distance = here, farthest = b;
    }
    const bool progress =
        s.load_share > s.look_share + 0.01 || s.now.ratio < 0.5 * s.look_ratio || distance < 2.0 * s.look_distance;
    s.suspicious = progress ? 0 : s.suspicious + 1;
    if (s.suspicious >= looks_needed && way_ahead(farthest, state) > far * std::sqrt(model.blocks.area[farthest]))
        s.now.moving = farthest;
    s.look_share = s.load_share;
    s.look_ratio = s.now.ratio;
    s.look_distance = distance;
    s.look_at = 2 * s.now.iterations;
}

}  // namespace talus
