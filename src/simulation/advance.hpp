// A run without its recorder: on to a moment, and on from there.
#pragma once

#include "simulation/simulation.hpp"

#include <functional>
#include <optional>
#include <string>

namespace talus {

using Say = std::function<void(const std::string&)>;  // what is being done, for who waits

/// A moment of a run: a time in s as results count it, or the begin of a stage by its name; empty: of the last stage.
class Moment {
public:
    /// Throws InputError if it is neither a time nor a stage of the scenario.
    Moment(const Scenario& scenario, const std::string& text);
    bool reached(const Simulation& simulation) const;
    const std::string& text() const { return text_; }

private:
    std::string text_;
    std::optional<double> time_;  // s
};

/// Begins the first stage and takes steps until the moment. Throws InputError if the run ends before.
void advance_to(Simulation& simulation, const Moment& moment, const Say& say);

/// One step, the first of the next stage if this one is over. False, and no step, if the run is.
bool step_on(Simulation& simulation);

}  // namespace talus
