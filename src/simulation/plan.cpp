#include "simulation/plan.hpp"

#include "core/errors.hpp"
#include "core/text.hpp"
#include "model/build.hpp"
#include "model/burden.hpp"
#include "scenario/springs.hpp"
#include "simulation/need.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace talus {
namespace {

// No closed form has been met to better than this: impulses are found to 1e-6 of the weight, forces of springs by steps of
// time.
constexpr double finest = 1e-6;

// Error of the rigid solver, as a share of a block, over the way of the fastest point in a step, as the same share: arches
// that fall have 0.1 of it.
constexpr double rigid_error = 0.5;
// Error of a rigid block that rocks, over the square of the step as a share of the time in which it falls through its own
// size: up to 14 were met among twenty blocks of all shapes.
constexpr double rocking_error = 64.0;

// Error of joints that give, over the square root of their closure: by as much corners are pressed in about which blocks
// turn, and an arch whose thickness is near its limit falls as if it were thinner. 85 there, 1 for a block that slides.
constexpr double spring_error = 100.0;
// In equilibrium, over the settlement: arches bend by seventy times what one of their joints closes.
constexpr double static_error = 100.0;
// Joints that give more than this share of a block are springs on purpose, and no rock.
constexpr double soft = 1e-2;
constexpr const char* stress_instead = "or accuracy: {joint_stress: ...}, for which what joints close is part of the answer";
constexpr int worth_freezing = 100;  // blocks; below, looking at them costs what it saves

std::string share(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2g", x);
    return text;
}

std::vector<TimeTable> tables_of(const Scenario& scenario) {
    std::vector<TimeTable> all{scenario.gravity.x, scenario.gravity.y, scenario.body_acceleration.x,
                               scenario.body_acceleration.y};
    const auto add = [&](const std::vector<LoadSpec>& loads) {
        for (const LoadSpec& load : loads) all.insert(all.end(), {load.force.x, load.force.y, load.moment});
    };
    add(scenario.loads);
    for (const BlockSpec& block : scenario.blocks)
        for (const auto* table : {&block.driven.velocity_x, &block.driven.velocity_y, &block.driven.spin})
            if (*table) all.push_back(**table);
    for (const StageSpec& stage : scenario.stages) {
        if (stage.gravity) all.insert(all.end(), {stage.gravity->x, stage.gravity->y});
        add(stage.loads);
    }
    return all;
}

/// s, at which steps see a table well enough: a straight piece is cut into 1 / sqrt(accuracy) steps, with an error of second
/// order; or, where it is a jump, the piece before it is, for a jump within a step comes up to half a step early or late.
double step_of(const TimeTable& table, double accuracy) {
    double step = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < table.time.size(); ++i) {
        const double piece = table.time[i] - table.time[i - 1];
        const double before = i > 1 ? table.time[i - 1] - table.time[i - 2] : table.time[i - 1];
        step = std::min(step, std::max(std::sqrt(accuracy) * piece, 0.5 * accuracy * before));
    }
    return step;
}

class Planner {
public:
    Planner(const Scenario& scenario, const Scene& scene)
        : plan_{{}, scenario},
          model_(scene.model),
          start_(scene.state),
          burden_(burden_of(scenario, scene.model, scene.state)),
          accuracy_(scenario.run.accuracy->least()),
          stages_(stages_of(plan_.scenario)) {
        for (const JointSpec& joint : scenario.joints)
            if (joint.normal_stiffness > 0.0) softest_ = std::min(softest_, joint.normal_stiffness);
    }

    Plan plan() {
        if (accuracy_ < finest)
            refuse("no solver is known to hold it; " + share(finest) + " can be reached where motion is regular");
        need_ = need_of_springs(scene(), stages_, model_, burden_);
        check_restitution();
        if (need_.gives_answer) ask_for_stiffness(need_.why);
        plan_.give_is_error = need_.give_is_error || (need_.open_is_error && !std::isfinite(softest_));
        if (!need_.remedy.empty()) plan_.warnings.push_back(need_.why + "; " + need_.remedy);
        plan_.remedy = need_.remedy;
        check_softness();
        choose_solvers();
        check_springs_left_out();
        check_resolution();
        choose_stiffness();
        check_give();
        choose_steps();
        choose_freezing();
        return std::move(plan_);
    }

private:
    Scenario& scene() { return plan_.scenario; }
    const Scenario& scene() const { return plan_.scenario; }
    RunSpec& run() { return plan_.scenario.run; }
    bool uses(const char* solver) const {
        return std::any_of(stages_.begin(), stages_.end(), [&](const StageView& s) { return *s.solver == solver; });
    }
    void choose(const std::string& what, const std::string& value, const std::string& why) {
        plan_.choices.push_back({what, value, why});
    }
    [[noreturn]] void refuse(const std::string& why) const {
        const AccuracySpec& asked = *plan_.scenario.run.accuracy;
        throw InputError({Fault{asked.where, "run.accuracy", share(accuracy_) + " cannot be reached: " + why}});
    }

    bool calms() const {
        return std::any_of(stages_.begin(), stages_.end(), [](const StageView& s) {
            return s.timeless() || s.damping->contact > 0.0 || s.damping->local > 0.0;
        });
    }

    // Joints with springs rebound as they like, however small the restitution that is stated; damping takes it.
    void check_restitution() const {
        const bool hits = has_restitution(scene()) && burden_.speed > 0.0 && !calms();
        if (!need_.why.empty() && (rebounds(scene()) || hits) && !uses("rigid"))
            refuse("a restitution is for the rigid solver, but " + need_.why);
    }

    // Motion is that of blocks whose joints do not give. Where they give more than the error, a column may lean or buckle.
    void check_springs_left_out() {
        const bool rigid = std::ranges::all_of(stages_, [](const StageView& s) { return *s.solver == "rigid"; });
        if (!rigid || !std::isfinite(softest_)) return;
        const double closed = burden_.settlement(softest_);
        if (closed > accuracy_)
            plan_.warnings.push_back("joints of the stiffness given close by " + share(closed) +
                                     " of a block, more than the accuracy, and the rigid solver takes them as closed: where "
                                     "blocks could lean or buckle on them, solver: static or explicit tells");
    }

    /// Refuses every joint whose stiffness is left open.
    void ask_for_stiffness(const std::string& why) const {
        std::vector<Fault> faults;
        const auto missing = [&](const JointSpec& joint, const std::string& key, const std::string& meaning) {
            faults.push_back(
                {joint.where, "joints." + joint.name + "." + key,
                 "is missing (number (Pa/m), > 0: " + meaning + "): " + why + ", which run.accuracy does not know"});
        };
        for (const JointSpec& joint : scene().joints) {
            if (joint.normal_stiffness == 0.0) missing(joint, "normal_stiffness", "stress per closure");
            if (joint.shear_stiffness == 0.0) missing(joint, "shear_stiffness", "stress per elastic shear displacement");
        }
        if (!faults.empty()) throw InputError(std::move(faults));
    }

    /// Movements that are asked for and are no more than what joints left open may close.
    void check_resolution() const {
        if ((!uses("explicit") && !uses("static")) || !calms()) return;
        if (const std::string small = asked_below(scene(), accuracy_, burden_.mean_size); !small.empty())
            ask_for_stiffness(small + " is no more than the accuracy leaves to joints (" +
                              number(accuracy_ * burden_.mean_size) + " m)");
    }

    void check_softness() const {
        const double closure = burden_.closure(softest_);
        if (plan_.give_is_error && closure > std::max(accuracy_, soft))
            refuse("joints of " + number(softest_) + " Pa/m close by " + share(closure) +
                   " of a block, which rigid ones do not; joints of no less than " + share(burden_.stiffness(soft)) +
                   " Pa/m would do, " + stress_instead);
    }

    void choose_solvers() {
        const bool moves = std::any_of(stages_.begin(), stages_.end(), [](const StageView& s) { return !s.timeless(); });
        const bool rigid = need_.why.empty() && moves;
        for (StageView& stage : stages_) {
            if (!stage.open) continue;
            const bool last = &stage == &stages_.back();
            const std::string key = stage.name == "run" && last ? "run.solver" : "solver of stage " + stage.name;
            if (rigid)
                choose(key, *stage.solver = "rigid", "nothing that is asked for depends on the stiffness of joints");
            else if (stage.timeless() && !(last && takes_time(scene())))
                choose(key, *stage.solver = "static",
                       need_.why.empty() ? "it ends in equilibrium, and no time is given"
                                         : "it ends in equilibrium; " + need_.why);
            else
                choose(key, *stage.solver = "explicit",
                       need_.why.empty()      ? "it ends in equilibrium, but something is driven"
                       : need_.remedy.empty() ? need_.why
                                              : need_.why + "; " + need_.remedy);
        }
    }

    /// Share of a block by which a joint may close.
    double closure_allowed() const {
        if (!need_.open_is_error || (!uses("explicit") && !uses("static"))) return 0.1 * accuracy_;
        if (uses("explicit") && !need_.at_rest) return std::pow(0.5 * accuracy_ / spring_error, 2);
        return uses("explicit") ? closure_by_settlement() : closure_of_statics();
    }

    double closure_by_settlement() const { return 0.5 * accuracy_ / (static_error * std::max(1.0, 0.5 * burden_.layers)); }

    /// Arches and columns near their limit fall where the settlement alone looks small, as mechanisms do. The static solver
    /// is as quick with stiff joints as with soft ones, as long as rounding of coordinates leaves forces in balance.
    double closure_of_statics() const {
        const double as_mechanism = std::pow(0.5 * accuracy_ / spring_error, 2);
        return std::min(closure_by_settlement(), std::max(as_mechanism, rounding()));
    }

    /// Closure of a joint of which the rounding of coordinates is as large a share as forces may be out of balance.
    double rounding() const {
        double farthest = 0.0, ratio = 1.0;
        for (BlockId b = 0; b < model_.blocks.size(); ++b)
            farthest = std::max(farthest, model_.blocks.start[b].norm() + model_.blocks.radius[b]);
        for (const StageView& stage : stages_)
            if (stage.until->equilibrium) ratio = std::min(ratio, *stage.until->equilibrium);
        return std::numeric_limits<double>::epsilon() * farthest / (burden_.mean_size * ratio);
    }

    void choose_stiffness() {
        const double closure = closure_allowed();
        const double kn = std::max(burden_.stiffness(closure), 1.0);
        const auto fill = [&](JointSpec& joint) {
            if (joint.normal_stiffness == 0.0) joint.normal_stiffness = kn;
            if (joint.shear_stiffness == 0.0) joint.shear_stiffness = 0.5 * joint.normal_stiffness;
        };
        for (JointSpec& joint : scene().joints) {
            const bool normal = joint.normal_stiffness == 0.0, shear = joint.shear_stiffness == 0.0;
            fill(joint);
            if (normal)
                choose("joints." + joint.name + ".normal_stiffness", share(joint.normal_stiffness) + " Pa/m",
                       uses("explicit") || uses("static")
                           ? "it closes by " + share(closure) + " of a block under all that is above"
                           : "not used but to share out the forces of bonds");
            if (shear)
                choose("joints." + joint.name + ".shear_stiffness", share(joint.shear_stiffness) + " Pa/m",
                       "half of the normal one");
        }
        for (StageSpec& stage : scene().stages)
            for (JointSpec& joint : stage.joints) fill(joint);
    }

    /// Where the stiffness is given and what joints close is error, it may be too much. A solver that is given has the
    /// benefit of the doubt.
    void check_give() {
        const bool moves = uses("explicit");
        if (!plan_.give_is_error || !std::isfinite(softest_) || (!moves && !uses("static"))) return;
        const bool given = !moves || std::any_of(stages_.begin(), stages_.end(),
                                                 [](const StageView& s) { return !s.open && *s.solver == "explicit"; });
        const double settlement = burden_.settlement(softest_);
        const double error = moves ? spring_error * std::sqrt(burden_.closure(softest_)) : static_error * settlement;
        const double surely = given ? settlement : error;
        const std::string give = "joints of " + number(softest_) + " Pa/m let the top settle by " + share(settlement) +
                                 " of a block and " + (moves ? "mechanisms" : "arches") + " be wrong by " + share(error);
        if (surely > accuracy_)
            refuse((need_.why.empty() ? "" : need_.why + ", and ") + give + "; " +
                   (surely < 0.4 ? share(1.1 * surely) + " could be, or " : "") + "use joints of no less than " +
                   share(stiffness_for(given)) + " Pa/m, or leave to the rigid solver what needs no springs, " +
                   stress_instead);
        if (error > accuracy_) plan_.warnings.push_back("accuracy " + share(accuracy_) + " is not certain: " + give);
    }

    /// Pa/m, at which the accuracy is met.
    double stiffness_for(bool given) const {
        return burden_.stiffness(given ? accuracy_ / std::max(1.0, 0.5 * burden_.layers)
                                       : std::pow(accuracy_ / spring_error, 2));
    }

    double time_of_fall() const { return std::sqrt(burden_.smallest_size / std::max(burden_.gravity, 1.0)); }

    void choose_steps() {
        if (uses("rigid")) choose_rigid_step();
        const bool waves = std::any_of(stages_.begin(), stages_.end(),
                                       [](const StageView& s) { return *s.solver == "explicit" && !s.until->equilibrium; });
        if (!waves || run().step_fraction_given) return;
        // Leapfrog is wrong by (omega dt)^2 / 24 in the period of an oscillation, and omega dt is at most twice the share.
        run().step_fraction = plan_.give_is_error ? 0.8 : std::min(0.8, std::sqrt(6.0 * accuracy_));
        choose("run.step_fraction", share(run().step_fraction),
               plan_.give_is_error ? "joints are stiff enough not to be seen, and how they ring neither"
                                   : "the fastest oscillation is then right to " + share(accuracy_));
    }

    /// Of the scene and of all stages, but for what carries the initial stress: it is in balance.
    std::vector<Load> all_loads() const {
        std::vector<Load> all(model_.loads.begin() + model_.boundary_loads, model_.loads.end());
        for (const StageSpec& stage : plan_.scenario.stages)
            for (const Load& load : make_loads(model_, start_, stage.loads)) all.push_back(load);
        return all;
    }

    void choose_rigid_step() {
        const double parts = std::sqrt(rocking_error / accuracy_);
        double most = time_of_fall() / parts;
        std::string way = "the smallest block falls through its size";
        if (const double pushed = step_of_fall(model_, all_loads(), 1.0 / parts); pushed < most * (1.0 - 1e-9))
            most = pushed, way = "a load pushes its block through its size";
        std::string why = "1/" + number(std::round(parts)) + " of the time in which " + way;
        for (const TimeTable& table : tables_of(scene())) {
            const double step = step_of(table, accuracy_);
            if (step < most) most = step, why = "what changes in time by a table, or jumps, is met well enough";
        }
        std::string chosen;
        for (StageView& stage : stages_) {
            if (*stage.solver != "rigid") continue;
            double step = most;
            if (stage.until->time)
                step = *stage.until->time /
                       std::ceil(*stage.until->time / std::min(step, *stage.until->time * std::sqrt(accuracy_)));
            if (!*stage.time_step)
                *stage.time_step = step, chosen = chosen.empty() || stage.name == "run" ? number(step) : chosen;
            else if (**stage.time_step > step * (1.0 + 1e-9))
                plan_.warnings.push_back("accuracy " + share(accuracy_) + " is not certain: time_step of " + stage.name +
                                         " is " + number(**stage.time_step) + " s, and " + number(step) +
                                         " s would hold it");
        }
        if (chosen.empty()) return;
        run().most_travel = accuracy_ / rigid_error * burden_.smallest_size;
        choose("run.time_step", chosen + " s",
               why + "; shorter while a block moves further than " + share(*run().most_travel) + " m in it");
    }

    void choose_freezing() {
        const bool damped = std::any_of(stages_.begin(), stages_.end(), [](const StageView& s) {
            return *s.solver == "explicit" && (s.damping->local > 0.0 || s.damping->contact > 0.0);
        });
        if (run().freeze_given || !damped || burden_.gravity == 0.0 || model_.blocks.size() < worth_freezing) return;
        run().freeze = std::min(0.1 * accuracy_, 0.1);
        choose("run.freeze", share(*run().freeze), "blocks at rest leave a tenth of the accuracy out of balance");
    }

    Plan plan_;
    const Model& model_;
    const State& start_;
    const Burden burden_;
    const double accuracy_;
    std::vector<StageView> stages_;
    Need need_;                                                 // why springs; empty: they are not needed
    double softest_ = std::numeric_limits<double>::infinity();  // Pa/m, of the joints whose stiffness is given
};

}  // namespace

Plan make_plan(const Scenario& scenario, const Scene& scene) {
    if (!scenario.run.accuracy) return {{}, scenario};
    return Planner(scenario, scene).plan();
}

void stiffen(const Scenario& scenario, Model& model, State& state) {
    for (std::size_t j = 0; j < scenario.joints.size(); ++j) model.joints[j] = make_joint(scenario.joints[j]);
    for (Contact& c : state.contacts.list) {
        const JointFace& face = model.faces[c.face];
        c.shear_energy = 0.5 * c.shear_force * c.shear_force / (model.joints[c.joint].ks * (face.s1 - face.s0));
    }
}

}  // namespace talus
