#include "simulation/record_boxes.hpp"

#include "core/errors.hpp"
#include "core/text.hpp"
#include "simulation/simulation.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace talus {
namespace {

std::optional<double> as_time(const std::string& text) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value) || value < 0.0) return {};
    return value;
}

/// Says when recording begins.
class Begin {
public:
    Begin(const Scenario& scenario, const std::string& from) : stage_(from), time_(from.empty() ? 0.0 : as_time(from)) {
        std::string names;
        for (const StageSpec& stage : scenario.stages) names += stage.name + ", ";
        const auto named = [&](const StageSpec& stage) { return stage.name == from; };
        if (!time_ && from != "run" && std::none_of(scenario.stages.begin(), scenario.stages.end(), named))
            throw InputError("from: '" + from + "' is neither a time in s nor a stage; there are: " + names + "run");
    }

    bool reached(const Simulation& simulation) {
        if (time_)
            begun_ = begun_ || (simulation.recorded() && simulation.state().time >= *time_ * (1.0 - 1e-12));
        else
            begun_ = begun_ || simulation.stage().name == stage_;
        return begun_;
    }

private:
    std::string stage_;
    std::optional<double> time_;  // s
    bool begun_ = false;
};

class Recording {
public:
    Recording(const Simulation& simulation, const RecordBoxes& what) : what_(what) {
        trajectory_.boxes = simulation.model().parts.size();
        check_trajectory_fits(std::to_string(trajectory_.boxes) + " boxes x " + std::to_string(what.steps) + " steps",
                              static_cast<double>(trajectory_.boxes), what.steps);
    }

    void look(const Simulation& simulation) {
        if (looks_++ % what_.every != 0) return;
        if (trajectory_.all.empty()) {
            trajectory_.dt = what_.every * simulation.time_step();
            trajectory_.all.reserve(trajectory_.boxes * what_.steps);
        }
        simulation.part_boxes(boxes_);
        trajectory_.all.insert(trajectory_.all.end(), boxes_.begin(), boxes_.end());
    }

    bool begun() const { return looks_ > 0; }
    bool complete() const {
        return std::ssize(trajectory_.all) == static_cast<std::ptrdiff_t>(trajectory_.boxes) * what_.steps;
    }
    Trajectory& trajectory() { return trajectory_; }

private:
    RecordBoxes what_;
    std::int64_t looks_ = 0;  // time steps since recording began
    Trajectory trajectory_;
    std::vector<Box> boxes_;
};

}  // namespace

Trajectory record_boxes(const Scenario& scenario, const RecordBoxes& what,
                        const std::function<void(const std::string&)>& say) {
    if (what.steps < 1 || what.every < 1) throw InputError("steps, every: less than 1");
    Begin begin(scenario, what.from);
    Simulation simulation(scenario, build(scenario));
    Recording recording(simulation, what);
    do {
        simulation.begin_stage();
        if (!recording.begun() && begin.reached(simulation)) recording.look(simulation);  // else seen at the end of the last
        while (!recording.complete() && !simulation.stage_over()) {
            simulation.step();
            if (begin.reached(simulation)) recording.look(simulation);
            say(simulation.stage().name + ": t = " + number(simulation.state().stage_time) + " s, " +
                std::to_string(recording.trajectory().steps()) + " of " + std::to_string(what.steps) + " steps recorded");
        }
    } while (!recording.complete() && simulation.end_stage());
    if (recording.trajectory().steps() == 0)
        throw InputError("the run ends at t = " + number(simulation.state().time) + " s, before recording begins (from " +
                         what.from + ")");
    return std::move(recording.trajectory());
}

}  // namespace talus
