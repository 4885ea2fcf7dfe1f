// The order of things: one step, one stage after the other. Owns Model, State and Scratch.
#pragma once

#include "contact/contacts.hpp"
#include "contact/search.hpp"
#include "core/stopwatch.hpp"
#include "dynamics/substeps.hpp"
#include "dynamics/time_step.hpp"
#include "model/awake.hpp"
#include "model/build.hpp"
#include "model/measure.hpp"
#include "model/placed.hpp"
#include "model/verdict.hpp"
#include "simulation/plan.hpp"
#include "statics/static_solver.hpp"
#include "verdict/footing.hpp"

#include <array>
#include <memory>
#include <span>
#include <string>

namespace talus {

namespace rigid {
struct Scratch;
}
struct Circumstances;

enum class Part { move, place, search, contacts, sum, account };  // of a step, for the timing
inline constexpr std::array<const char*, 6> part_names{"move", "place", "search", "contacts", "sum", "account"};

// A leapfrog below its limit gains nothing but what contacts make that open or close within a step: less than 1e-3 in all
// examples. Half of the alarm warns hardly earlier, for what is unstable gains several times its energy.
inline constexpr double energy_alarm = 0.05;
// What explodes passes this within a look or two. Undamped blocks that ring for thousands of steps come to 1 slowly: they
// are warned of, and may go on.
inline constexpr double energy_explosion = 10.0;

class Simulation {
public:
    /// A scene at its very start.
    Simulation(const Scenario& scenario, Scene scene);
    /// Goes on from a saved state of the same scenario, bit for bit.
    Simulation(const Scenario& scenario, Scene scene, State saved);
    Simulation(Simulation&&) noexcept;
    ~Simulation();

    /// Prepares stage `state().stage`: deletes blocks, changes properties, chooses the step. Called by run() at the start of
    /// every stage, not after a restart in its middle. Throws InputError if a time step of the user is above the stable
    /// estimate or a block is not there, at the first stage also for what can be known of later ones.
    void begin_stage();
    /// Notes whether it found the equilibrium it was to end in, resets what it asks for and moves on; false if it was the
    /// last.
    bool end_stage();

    void step();              // one time step; the last one of a timed stage is cut to end exactly
    bool stage_over() const;  // by time, by equilibrium (looked at every 10 steps), or by a verdict

    const Scenario& scenario() const { return scenario_; }  // with nothing left open
    const Decisions& decisions() const { return decisions_; }
    const Model& model() const { return model_; }
    const State& state() const { return state_; }
    const Placed& placed() const { return placed_; }
    State first_state() const { return state_at_start(model_); }
    const StageSpec& stage() const { return stages_[state_.stage]; }
    const StageSpec& stage(int k) const { return stages_[k]; }
    int stage_count() const { return static_cast<int>(stages_.size()); }
    const StableStep& stable() const { return stable_; }
    const BuildReport& report() const { return report_; }
    double skin() const { return skin_; }
    bool timeless() const { return stage().solver == "static"; }       // no time passes in this stage
    double time_step() const;                                          // s, of the next step (before the cut at the end)
    bool recorded() const { return state_.stage >= first_recorded_; }  // no later stage sets the clock back
    double recorded_time() const;  // s, length of the recorded stages as far as it is given
    bool reached_equilibrium() const;
    bool ended_by_verdict() const;  // it is certain whether the blocks stand, and the stage was to end then
    StabilityVerdict verdict() const;
    Energies energies() const;
    double energy_drift() const { return energies().total() - state_.ledger.total0; }  // J
    /// Largest energy that came from nowhere, over the largest energy of the run (at least the work of gravity, of loads and
    /// of driven blocks); looked at every 100 steps and at the last whole step of a stage that has a time. The oscillation
    /// of the leapfrog, which comes and goes, does not count. Above `energy_alarm` the run is not to be trusted; beyond
    /// `energy_explosion` it diverges.
    double energy_gain() const;
    std::int64_t steps_done() const { return steps_done_; }        // in this process
    double ledger_error() const;                                   // J
    double max_speed() const { return speed_; }                    // m/s, in the last step
    std::int64_t refreshes() const { return refreshes_; }          // how often the list of pairs was renewed
    std::int64_t boxes_renewed() const { return boxes_renewed_; }  // of how many blocks, over all refreshes
    /// Contacts and blocks that are computed without substeps, over those with the substeps that save most; 1 if none do.
    double gain_of_substeps() const;
    double frozen_share() const;  // of the blocks, in the mean of the steps done in this process in which blocks may freeze
    std::string search_choice() const { return search_->choice(); }  // see PairSearch::choice
    /// s, that the parts of all steps took; from one step in seven where blocks are few, for clocks take time as well.
    const std::array<double, part_names.size()>& seconds() const { return seconds_; }

    /// [np] boxes of the convex parts as they are now, without skin; absent ones as in part_boxes.hpp.
    void part_boxes(std::vector<Box>& boxes) const;

    /// Throws away everything that is not State; what follows is the same. For tests.
    void drop_scratch();

private:
    Simulation(Plan plan, Scene&& scene);  // a reference: the plan is made before the scene is taken

    /// A way to advance, by the name it has in a scenario.
    struct Method {
        const char* name;
        /// Brings contacts and the forces of now up to date, at the start of a stage and before blocks are deleted; 0 = no
        /// slip.
        void (Simulation::*forces)(double dt);
        void (Simulation::*begin)();          // of a stage: chooses state_.stage_step, or refuses
        void (Simulation::*step)(double dt);  // moves state_ on by dt, with time, ledger and speed_
        bool springs;                         // contacts store energy, and the ledger takes velocities of half steps
    };
    const Method& method() const;  // of this stage

    void begin_explicit();
    void step_explicit(double dt);
    void move(double dt);
    void begin_substeps(double& dt);  // chooses them, and with them the step
    void move_in_substeps(double dt);
    void forces_in_substep(int parts, double part);
    void forces_of_step(double dt);
    void check_energy_explicit(double most);

    void forces_rigid(double dt);
    void begin_rigid();
    void step_rigid(double dt);
    bool half_step_rigid(double dt);
    void finish_step_rigid(double dt);
    bool short_enough_rigid(double speed);
    bool one_by_one_rigid(double dt);
    bool worth_a_cut_rigid(double later) const;
    void find_and_solve_rigid(bool rebounds, double dt);
    void check_overlaps_rigid() const;
    void renew_pairs_rigid(double reach);
    bool break_bonds_rigid(double dt);
    double rigid_resolution(double dt) const;
    double fall_rigid() const;
    void account_rigid(const Motion& start, std::span<const Vec2> middle, double dt);

    void begin_static();
    void forces_static();
    void step_static(double dt);
    bool static_over() const;
    void come_to_rest();
    void keep_forces();
    void freeze_and_wake();
    void find_awake(bool list_renewed = false);  // then, or after blocks froze or woke

    Circumstances circumstances() const;
    bool loads_are_on() const;
    void look_at_blocks();

    void note_if_unsettled();
    void apply_stage();  // what a stage changes in the model; idempotent
    void delete_blocks();
    void check_stages() const;
    void check_timeless() const;
    void update_forces(double dt);
    void renew_list();
    void sum_forces();
    void refresh(double skin);
    void check_speed() const;
    /// Throws if more than `most` of the largest energy was `gained` (J) since the start, from nowhere.
    void check_energy(const Energies& now, double gained, double most);
    void look_for_calm();
    void check_that_it_stays() const;
    void check_overlaps();
    int halvings_for(double speed) const;
    void lap(Part part) {
        if (timed_) seconds_[static_cast<int>(part)] += timed_ * watch_.lap();
    }

    const Scenario scenario_;
    const Decisions decisions_;
    std::vector<StageSpec> stages_;  // those of the scenario and, last, `run`
    Model model_;
    State state_;
    int first_recorded_ = 0;
    BuildReport report_;
    std::vector<Load> boundary_loads_;  // of initial stress: always there
    std::vector<DrivenBlock> driven_;   // act in the last stage only

    Awake awake_;  // Scratch from here on
    Paces paces_;
    Placed placed_;
    std::unique_ptr<PairSearch> search_;
    std::vector<Pair> pairs_;
    ContactIndex contact_index_;
    std::vector<Box> boxes_;             // [np] grown by the skin
    std::vector<std::uint8_t> reboxed_;  // [nb] 1 = got new boxes at the last refresh
    std::vector<Force> load_before_, damping_before_;
    std::vector<std::uint8_t> was_frozen_;  // [nb] as the contacts are sorted
    std::vector<Rest> rest_;                // [nb] empty while nothing freezes
    Vec2 resting_gravity_;                  // m/s2, for which the load of all that rests was found; NaN = not yet
    double skin_ = 0.0;
    std::unique_ptr<StaticSolver> statics_;
    Footing footing_;
    std::unique_ptr<rigid::Scratch> rigid_;  // of the rigid solver, while it is at work

    StableStep stable_;
    double narrowest_ = 0.0;           // m, see there
    std::vector<double> sharp_turns_;  // s, of the stage; see there
    double speed_ = 0.0;
    std::int64_t refreshes_ = 0, boxes_renewed_ = 0, steps_done_ = 0;
    std::int64_t freezing_steps_ = 0;  // in which blocks may freeze
    std::int64_t moved_ = 0;           // blocks that were computed, summed over these
    std::array<double, part_names.size()> seconds_{};
    Stopwatch watch_;
    int timed_ = 1;  // steps that this one stands for; 0 = it is not timed
};

}  // namespace talus
