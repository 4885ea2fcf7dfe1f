#include "simulation/advance.hpp"

#include "core/errors.hpp"
#include "core/text.hpp"

#include <charconv>
#include <cmath>

namespace talus {
namespace {

constexpr const char* last_stage = "run";

std::optional<double> as_time(const std::string& text) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value) || value < 0.0) return {};
    return value;
}

}  // namespace

Moment::Moment(const Scenario& scenario, const std::string& text) : text_(text), time_(as_time(text)) {
    if (text.empty()) return;
    std::string names;
    for (const StageSpec& stage : scenario.stages) {
        if (stage.name == text) return;
        names += stage.name + ", ";
    }
    if (!time_ && text != last_stage)
        throw InputError("from: '" + text + "' is neither a time in s nor a stage; there are: " + names + last_stage);
}

bool Moment::reached(const Simulation& simulation) const {
    if (time_) return simulation.recorded() && simulation.state().time >= *time_ * (1.0 - 1e-12);
    if (text_.empty()) return simulation.state().stage + 1 == simulation.stage_count();
    return simulation.stage().name == text_;
}

void advance_to(Simulation& simulation, const Moment& moment, const Say& say) {
    simulation.begin_stage();
    while (!moment.reached(simulation)) {
        if (!simulation.stage_over()) {
            simulation.step();
            say("running, " + simulation.stage().name + ": t = " + number(simulation.state().stage_time) + " s");
        } else if (simulation.end_stage()) {
            simulation.begin_stage();
        } else {
            throw InputError("from: the run ends at t = " + number(simulation.state().time) + " s, before " + moment.text());
        }
    }
}

bool step_on(Simulation& simulation) {
    while (simulation.stage_over()) {
        if (!simulation.end_stage()) return false;
        simulation.begin_stage();
    }
    simulation.step();
    return true;
}

}  // namespace talus
