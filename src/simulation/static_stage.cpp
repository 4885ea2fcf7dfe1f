// The static method: iterations instead of time.
#include "core/errors.hpp"
#include "dynamics/motion.hpp"
#include "simulation/simulation.hpp"

#include <algorithm>

namespace talus {
namespace {

constexpr std::int64_t default_iterations = 100000;  // of 10,000 blocks: some minutes

bool moves(const TimeTable& table) {
    return std::ranges::any_of(table.value, [](double v) { return v != 0.0; });
}

}  // namespace

// What takes time cannot be in a stage without time; before the last one it stands still anyway.
void Simulation::check_timeless() const {
    std::vector<Fault> faults;
    for (const BlockSpec& block : scenario_.blocks) {
        const DrivenSpec& d = block.driven;
        const auto drives = [&](const std::optional<TimeTable>& table) { return table && moves(*table); };
        if (drives(d.velocity_x) || drives(d.velocity_y) || drives(d.spin))
            faults.push_back(
                {block.where, "blocks." + block.name + ".driven",
                 "a prescribed velocity takes time, and none passes in a static stage: use another solver there"});
    }
    if (!scenario_.body_acceleration.x.is_constant() || !scenario_.body_acceleration.y.is_constant())
        faults.push_back({{scenario_.file, 0},
                          "body_acceleration",
                          "motion of the ground takes time, and none passes in a static stage: use another solver there, or "
                          "one value for all times"});
    if (!faults.empty()) throw InputError(std::move(faults));
}

void Simulation::begin_static() {
    stable_ = {};
    state_.stage_step = 0.0;
    std::ranges::fill(state_.motion.velocity, Vec2::Zero());
    std::ranges::fill(state_.motion.spin, 0.0);
    statics_ = std::make_unique<StaticSolver>(model_, state_);
    statics_->begin(model_, *stage().until.equilibrium, state_);
}

void Simulation::forces_static() {
    load_before_.swap(state_.load);
    state_.load.resize(load_before_.size());
    update_forces(1.0);
    hold_back(state_.statics, state_.load);
    speed_ = account(model_, awake_, {load_before_, {}}, {state_.load, {}}, state_, 1.0, state_.ledger);
    lap(Part::account);
    check_speed();
    ++state_.statics.now.evaluations;
}

void Simulation::step_static(double) {
    if (!statics_) statics_ = std::make_unique<StaticSolver>(model_, state_);
    if (placed_.block.empty()) place(model_, awake_, state_.motion, skin_, placed_);
    const std::int64_t lists = refreshes_;
    const Forces forces{[this] { forces_static(); },
                        [this, lists] {
                            if (refreshes_ != lists) placed_.boxed.clear();  // the list is that of before again
                            for (ContactIndex::Chunk& chunk : contact_index_.chunks) chunk.sorted = false;
                            place(model_, awake_, state_.motion, skin_, placed_);
                        }};
    statics_->iterate(model_, placed_, *stage().until.equilibrium, forces, state_);
    if (static_over()) come_to_rest();
}

bool Simulation::static_over() const {
    const StaticEvidence& now = state_.statics.now;
    return now.reached || now.moving >= 0 || now.iterations >= stage().until.iterations.value_or(default_iterations);
}

// What the relaxation took is what is missing in the balance.
void Simulation::come_to_rest() {
    std::ranges::fill(state_.motion.velocity, Vec2::Zero());
    std::ranges::fill(state_.motion.spin, 0.0);
    state_.ledger.local_damping += energies().total() - state_.ledger.total0;
}

}  // namespace talus
