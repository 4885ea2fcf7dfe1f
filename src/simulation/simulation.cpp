#include "simulation/simulation.hpp"

#include "core/errors.hpp"
#include "core/memory.hpp"
#include "dynamics/motion.hpp"
#include "model/part_boxes.hpp"
#include "model/title.hpp"
#include "rigid/scratch.hpp"
#include "verdict/course.hpp"

#ifdef _OPENMP
#include <omp.h>
#endif

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string_view>
#include <utility>

namespace talus {
namespace {

// Blocks: below, reading clocks between the parts of a step takes more than some hundredths of it.
constexpr int a_clock_counts = 100;
constexpr int calm_interval = 10;    // steps between looks at the unbalanced ratio
constexpr int stay_interval = 1000;  // steps between looks whether a block has left the scene
constexpr int calm_needed = 3;       // looks in a row below the limit: one may be a turning point of the motion

StageSpec last_stage(const Scenario& scenario) {
    StageSpec stage;
    stage.name = "run";
    stage.solver = scenario.run.solver;
    stage.until = scenario.run.until;
    stage.damping = scenario.run.damping;
    stage.time_step = scenario.run.time_step;
    stage.time_step_where = scenario.run.time_step_where;
    return stage;
}

// m: boxes a twentieth of a block larger than it is are left every few hundred steps in a fast slope, and hold hardly more
// pairs (0-4 %); half of it doubles the refreshes, twice of it adds pairs.
double default_skin(const Model& model) {
    std::vector<double> area = model.blocks.area;
    if (area.empty()) return 0.0;
    const auto middle = area.begin() + static_cast<std::ptrdiff_t>(area.size() / 2);
    std::nth_element(area.begin(), middle, area.end());
    return 0.05 * std::sqrt(*middle);
}

VectorTable frozen(const VectorTable& table) { return {table.x.frozen(), table.y.frozen()}; }

// In a static stage tables have their last value, what fades has faded, and nothing depends on velocities.
void stop_time(Model& model) {
    model.gravity_x = model.gravity_x.at_the_end();
    model.gravity_y = model.gravity_y.at_the_end();
    for (Load& l : model.loads) l = {l.block, l.arm, l.force_x.at_the_end(), l.force_y.at_the_end(), l.moment.at_the_end()};
    model.local_damping = model.contact_damping = model.release_time = 0.0;
}

void change_joints(const StageSpec& stage, Model& model) {
    for (const JointSpec& joint : stage.joints)
        for (Joint& mine : model.joints)
            if (mine.name == joint.name) mine = make_joint(joint);
}

std::string refusal(const StableStep& stable) {
    std::ostringstream text;
    text << "is above the stable step, estimated at " << stable.estimate << " s (rigorous bound " << stable.bound
         << " s); leave it out, or set run.unchecked: true to see what happens";
    return text.str();
}

std::vector<StageSpec> stages_of(const Scenario& scenario) {
    std::vector<StageSpec> stages = scenario.stages;
    if (scenario.run.until.time || scenario.run.until.equilibrium || stages.empty()) stages.push_back(last_stage(scenario));
    for (StageSpec& stage : stages)
        if (stage.solver == "auto") stage.solver = "explicit";
    return stages;
}

}  // namespace

Simulation::Simulation(const Scenario& scenario, Scene scene) : Simulation(make_plan(scenario, scene), std::move(scene)) {}

Simulation::Simulation(Plan plan, Scene&& scene)
    : scenario_(std::move(plan.scenario)),
      decisions_(plan),
      stages_(stages_of(scenario_)),
      model_(std::move(scene.model)),
      state_(std::move(scene.state)),
      report_(std::move(scene.report)),
      driven_(std::exchange(model_.driven, {})),
      awake_(all_awake(model_.blocks.size())),
      search_(make_search(scenario_.run.search)),
      skin_(scenario_.run.skin.value_or(default_skin(model_))) {
#ifdef _OPENMP
    omp_set_num_threads(scenario_.run.threads);
#endif
    if (scenario_.run.accuracy) stiffen(scenario_, model_, state_);
    report_.warnings.insert(report_.warnings.end(), decisions_.warnings.begin(), decisions_.warnings.end());
    boundary_loads_.assign(model_.loads.begin(), model_.loads.begin() + model_.boundary_loads);
    for (int i = 0; i + 1 < stage_count(); ++i)
        if (stages_[i].reset) first_recorded_ = i + 1;
}

Simulation::Simulation(const Scenario& scenario, Scene scene, State saved) : Simulation(scenario, std::move(scene)) {
    state_ = std::move(saved);
    apply_stage();
    place(model_, awake_, state_.motion, skin_, placed_);
    find_awake();
    stable_ = stable_step(model_, placed_, state_);
    narrowest_ = narrowest(model_, state_);
    if (method().springs && !timeless()) sharp_turns_ = sharp_turns(model_, state_.stage_step);
}

Simulation::Simulation(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

// ---- one step -------------------------------------------------------------------------------------------------------

const Simulation::Method& Simulation::method() const {
    static constexpr std::array methods{
        Method{"explicit", &Simulation::update_forces, &Simulation::begin_explicit, &Simulation::step_explicit, true},
        Method{"rigid", &Simulation::forces_rigid, &Simulation::begin_rigid, &Simulation::step_rigid, false},
        Method{"static", &Simulation::update_forces, &Simulation::begin_static, &Simulation::step_static, true},
    };
    return *std::ranges::find(methods, stage().solver, [](const Method& m) { return std::string_view(m.name); });
}

void Simulation::step() {
    const double dt = time_step();
    ++state_.step;
    ++state_.total_steps;
    const int every = model_.blocks.size() < a_clock_counts ? 7 : 1;
    timed_ = steps_done_++ % every == 0 ? every : 0;
    if (timed_) watch_.lap();
    (this->*method().step)(dt);
    if (look_is_due(state_)) look_at_blocks();
    if (!timeless()) look_for_calm();
    lap(Part::move);
}

void Simulation::check_speed() const {
    if (std::isfinite(speed_)) return;
    for (BlockId b = 0; b < model_.blocks.size(); ++b) {
        const Vec2& v = state_.motion.velocity[b];
        if (std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(state_.motion.spin[b])) continue;
        throw DivergenceError(title_and_place(model_, b) + " at the start has no finite velocity any more: t = " +
                              std::to_string(state_.time) + " s, step " + std::to_string(state_.total_steps) +
                              "; the step is too long for the stiffness, or loads grow without bound: leave "
                              "run.time_step out, or look at the last frame");
    }
}

void Simulation::check_energy(const Energies& e, double gained, double most) {
    Ledger& ledger = state_.ledger;
    const double there = ledger.total0 + e.gravity + e.loads + e.driven;
    ledger.largest = std::max({ledger.largest, there, std::abs(e.gravity), std::abs(e.loads), std::abs(e.driven)});
    ledger.gained = std::max(ledger.gained, gained);
    if (gained <= most * ledger.largest) return;
    std::ostringstream text;
    text << "blocks gained " << gained << " J from nowhere, the largest energy of the run is " << ledger.largest
         << " J: t = " << state_.time << " s, step " << state_.total_steps << " of " << state_.stage_step << " s";
    if (method().springs) text << " (limit estimated at " << stable_.estimate << " s)";
    text << ": leave the time step out, or look at the last frames";
    throw DivergenceError(text.str());
}

double Simulation::recorded_time() const {
    double length = 0.0;
    for (int i = first_recorded_; i < stage_count(); ++i)
        if (stages_[i].solver != "static") length += stages_[i].until.time.value_or(0.0);
    return length;
}

double Simulation::time_step() const {
    const double dt = std::ldexp(state_.stage_step, -state_.step_halvings);
    if (!stage().until.time || timeless()) return dt;
    double left = *stage().until.time - state_.stage_time;
    const auto turn = std::ranges::upper_bound(sharp_turns_, state_.stage_time + 1e-9 * dt);
    if (turn != sharp_turns_.end()) left = std::min(left, *turn - state_.stage_time);
    return left < dt * (1.0 + 1e-9) ? left : dt;
}

// ---- pairs ----------------------------------------------------------------------------------------------------------

void Simulation::refresh(double skin) {
    boxes_renewed_ += rebox(model_, state_, skin, placed_, boxes_, reboxed_);
    search_->find(boxes_, pairs_);
    refresh_contacts(model_, placed_, pairs_, reboxed_, skin, state_, contact_index_);
    ++refreshes_;
}

void Simulation::part_boxes(std::vector<Box>& boxes) const { talus::part_boxes(model_, state_, placed_, boxes); }

void Simulation::drop_scratch() {
    placed_ = {};
    search_ = make_search(scenario_.run.search);
    pairs_.clear();
    statics_.reset();
    rigid_.reset();
    paces_ = {};
    awake_ = all_awake(model_.blocks.size());
    place(model_, awake_, state_.motion, skin_, placed_);
    find_awake();
}

// ---- stages ---------------------------------------------------------------------------------------------------------

void Simulation::apply_stage() {
    const bool last = state_.stage + 1 == stage_count();
    for (int i = 0; i <= state_.stage; ++i) change_joints(stages_[i], model_);
    model_.local_damping = stage().damping.local;
    model_.contact_damping = stage().damping.contact;
    model_.release_time = stage().release;

    // Tables of the scene run with the last stage; before it they stand still at their first value.
    const VectorTable gravity = stage().gravity ? *stage().gravity : last ? scenario_.gravity : frozen(scenario_.gravity);
    const VectorTable shaking = last ? scenario_.body_acceleration : frozen(scenario_.body_acceleration);
    model_.gravity_x = gravity.x + shaking.x;
    model_.gravity_y = gravity.y + shaking.y;
    model_.loads = boundary_loads_;
    for (Load load : make_loads(model_, state_, stage().loads_given ? stage().loads : scenario_.loads)) {
        if (!last && !stage().loads_given)
            load = {load.block, load.arm, load.force_x.frozen(), load.force_y.frozen(), load.moment.frozen()};
        model_.loads.push_back(load);
    }
    if (timeless()) stop_time(model_);
    for (BlockId b = 0; b < model_.blocks.size(); ++b) {
        if (!state_.removed[b]) continue;
        model_.blocks.inv_mass[b].setZero();
        model_.blocks.inv_inertia[b] = 0.0;
    }
    model_.driven = driven_;
    if (!last)
        for (DrivenBlock& d : model_.driven) d.velocity_x = d.velocity_y = d.spin = TimeTable{};
}

void Simulation::delete_blocks() {
    std::vector<BlockId> gone;
    for (const Selector& selector : stage().remove)
        for (BlockId b : select(model_, state_, selector)) gone.push_back(b);
    for (BlockId b : gone) state_.removed[b] = 1;
    if (stage().release > 0.0) state_.release.assign(model_.blocks.size(), Force{});
    for (std::size_t i = 0; i < state_.contacts.list.size() && !state_.release.empty(); ++i) {
        const Contact& c = state_.contacts.list[i];
        const BlockId a = model_.parts.block[c.part_a], b = model_.parts.block[c.part_b];
        if (!c.touching || state_.removed[a] == state_.removed[b]) continue;
        const BlockId stays = state_.removed[a] ? b : a;
        const Reaction& r = state_.contacts.reaction[i];
        state_.release[stays].force += stays == b ? r.force : Vec2(-r.force);
        state_.release[stays].torque += stays == b ? r.torque_b : r.torque_a;
    }
    for (BlockId b : gone) {
        state_.motion.velocity[b].setZero();
        state_.motion.spin[b] = 0.0;
    }
    placed_.boxed.clear();
}

// Of stages to come as much as can be known before the first step: with the blocks, joints and damping that they will have,
// but with the contacts of now. Each is looked at again, with its own contacts, when it begins.
void Simulation::check_stages() const {
    if (state_.total_steps == 0 && stages_.back().solver == "static") check_timeless();
    const int end = state_.total_steps == 0 ? stage_count() : state_.stage + 1;
    if (state_.total_steps > 0 && !stage().time_step) return;
    Model model = model_;
    State state = state_;
    std::vector<Fault> faults;
    for (int i = state_.stage; i < end; ++i) {
        const StageSpec& at = stages_[i];
        if (i > state_.stage) {
            for (const Selector& selector : at.remove)
                for (BlockId b : select(model, state, selector)) state.removed[b] = 1;
            make_loads(model, state, at.loads_given ? at.loads : scenario_.loads);  // throws if a block is not there
            std::erase_if(state.contacts.list.edit(), [&](const Contact& c) {
                return state.removed[model.parts.block[c.part_a]] || state.removed[model.parts.block[c.part_b]];
            });
        }
        change_joints(at, model);
        model.contact_damping = at.damping.contact;
        if (!at.time_step || scenario_.run.unchecked || at.solver != "explicit") continue;
        const StableStep stable = stable_step(model, placed_, state);
        const bool listed = i < static_cast<int>(scenario_.stages.size());
        // Only small blocks that take several steps in one allow a longer one; in equilibrium none do (begin_substeps).
        const int substeps = scenario_.run.substeps == 1 || at.until.equilibrium
                                 ? 1
                                 : substeps_of_step(model, state, block_limits(model, placed_, state),
                                                    scenario_.run.substeps, *at.time_step, scenario_.run.step_fraction)
                                       .count;
        if (*at.time_step > substeps * stable.estimate)
            faults.push_back({at.time_step_where, (listed ? "stages[" + std::to_string(i) + "]" : "run") + ".time_step",
                              refusal(stable)});
    }
    if (!faults.empty()) throw InputError(std::move(faults));
}

void Simulation::begin_stage() {
    // What a stage changes (blocks deleted, stiffness) is no drift of the integration.
    const double drift = state_.step > 0 ? energy_drift() : 0.0;
    state_.stage_time = 0.0;
    state_.step_halvings = 0;
    sharp_turns_.clear();
    state_.damping.clear();
    state_.release.clear();
    state_.calm.clear();
    if (!state_.fast.empty()) placed_.boxed.clear();  // the list has chunks for each pace
    state_.fast.clear();
    state_.substeps = 1;
    find_awake();
    state_.calm_checks = 0;
    const std::vector<Joint> before = model_.joints;
    apply_stage();
    // The shear force of a contact stays, what it stores goes with its stiffness.
    for (Contact& c : state_.contacts.list) c.shear_energy *= before[c.joint].ks / model_.joints[c.joint].ks;
    if (!stage().remove.empty()) {
        (this->*method().forces)(0.0);
        delete_blocks();
        apply_stage();
    }
    drive(model_, 0.0, state_.motion);
    (this->*method().forces)(0.0);
    check_stages();
    (this->*method().begin)();
    state_.ledger.kinetic0 += ledger_error();
    state_.ledger.total0 = energies().total() - drift;
    if (recorded() && !timeless())
        begin_course(model_, circumstances(), state_);
    else
        state_.course = {};
    release_unused_memory();
}

// In the state, so that a run that is resumed later does not forget it. A finished run that is resumed ends its last stage
// again.
void Simulation::note_if_unsettled() {
    if (!stage().until.equilibrium || reached_equilibrium() || ended_by_verdict()) return;
    if (state_.unsettled.empty() || state_.unsettled.back().stage != state_.stage)
        state_.unsettled.push_back({state_.stage, unbalanced_ratio(model_, state_)});
}

bool Simulation::end_stage() {
    note_if_unsettled();
    if (state_.stage + 1 == stage_count()) return false;  // a reset prepares what follows; here nothing does
    if (stage().reset) {
        state_.earlier_gain = energy_gain();
        const int nb = model_.blocks.size();
        for (BlockId b = 0; b < nb; ++b) {
            if (model_.blocks.held(b)) continue;
            state_.motion.velocity[b].setZero();
            state_.motion.spin[b] = 0.0;
        }
        state_.start_position = state_.motion.position;
        state_.start_angle = state_.motion.angle;
        state_.time = 0.0;
        state_.step = 0;
        state_.ledger = Ledger{};
        state_.course = {};
        for (Contact& c : state_.contacts.list)
            if (c.dilation == 0.0) c.slip = c.slip_sum = 0.0;
    }
    ++state_.stage;
    return true;
}

bool Simulation::stage_over() const {
    if (timeless()) return static_over();
    const Until& until = stage().until;
    if (ended_by_verdict() || reached_equilibrium()) return true;
    return until.time && state_.stage_time >= *until.time * (1.0 - 1e-12);
}

bool Simulation::reached_equilibrium() const {
    return timeless() ? state_.statics.now.reached != 0 : state_.calm_checks >= calm_needed;
}

void Simulation::look_for_calm() {
    const Until& until = stage().until;
    if (!until.equilibrium || state_.step % calm_interval != 0) return;
    state_.calm_checks = unbalanced_ratio(model_, state_) < *until.equilibrium ? state_.calm_checks + 1 : 0;
    if (!until.time && state_.step % stay_interval == 0) check_that_it_stays();
}

// A stage that lasts until all rest has no end when a block falls out of the scene.
void Simulation::check_that_it_stays() const {
    Vec2 low = model_.blocks.start.front(), high = low;
    for (const Vec2& p : model_.blocks.start) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const double reach = (high - low).norm() + std::ranges::max(model_.blocks.radius);
    for (BlockId b = 0; b < model_.blocks.size(); ++b) {
        const Vec2 way = state_.motion.position[b] - model_.blocks.start[b];
        const bool goes_on =
            way.dot(state_.motion.velocity[b]) > 0.1 * std::sqrt(reach) * way.norm();  // m/s, of a fall of reach
        if (state_.removed[b] || !goes_on || way.norm() < 2.0 * reach) continue;
        std::ostringstream text;
        text << "stage " << stage().name << " comes to no equilibrium: block " << b;
        if (!model_.blocks.name[b].empty()) text << " `" << model_.blocks.name[b] << "`";
        text << " has left the scene, is " << way.norm() << " m from its place, and goes on; give it something to rest on, "
             << "delete it, or end the stage by until.time";
        throw DivergenceError(text.str());
    }
}

// ---- numbers --------------------------------------------------------------------------------------------------------

Energies Simulation::energies() const {
    const StrainEnergy strain = method().springs ? strain_energy(model_, placed_, state_) : StrainEnergy{};
    const Ledger& l = state_.ledger;
    Energies e;
    e.kinetic = kinetic_energy(model_, state_);
    e.strain_normal = strain.normal;
    e.strain_shear = strain.shear;
    e.friction = l.friction;
    e.contact_damping = l.contact_damping;
    e.local_damping = 0.0 - l.local_damping;
    e.released = l.released;
    e.gravity = l.gravity;
    e.loads = l.loads;
    e.driven = l.driven;
    return e;
}

double Simulation::energy_gain() const {
    const Ledger& ledger = state_.ledger;
    return std::max(state_.earlier_gain, ledger.gained > 0.0 ? ledger.gained / ledger.largest : 0.0);
}

double Simulation::ledger_error() const {
    return talus::ledger_error(model_, state_, method().springs ? state_.ledger_step() : 0.0);
}

}  // namespace talus
