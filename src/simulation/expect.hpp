// What a scenario expects of its own run: watched at every step, judged at the end.
#pragma once

#include "model/probe.hpp"
#include "model/verdict.hpp"
#include "scenario/scenario.hpp"
#include "simulation/signal.hpp"

#include <optional>
#include <string>
#include <vector>

namespace talus {

struct Verdict {
    std::string what;  // "velocity.along at (1, 2), rate 0.5..1 s"
    double measured;   // NaN: the run did not get there, or there is nothing to measure
    double expected;   // the value, or the bound that must not be crossed
    double error;      // |measured - expected|, or how far the bound is crossed
    double allowed;    // passed if error <= allowed
    bool passed;
    const char* asked = "expected";  // or "above", "below"
};

/// What a run had to say beside its numbers.
struct Told {
    std::string fault;                        // why it was refused or ended early; empty: it came to its end
    std::vector<std::string> warnings;        // about the scene, and about how the run went
    std::optional<StabilityVerdict> verdict;  // none: the run did not come to its end
};

/// Whether what was expected to be told was: a fault, or a warning, or the verdict on the whole or on block `block` (-1: the
/// whole). Measured: 1 told, 0 not.
Verdict judge(const ExpectSpec& expect, const Told& told, BlockId block = -1);
bool about_what_is_told(const ExpectSpec& expect);
bool about_the_verdict(const ExpectSpec& expect);

/// What one expectation says about signals already recorded; `against` is the second axis of loop_area.
///   value      the signal at `at`, or at its end           rate       mean rate of change between two times
///   max, min   over `between`, or over all                 frequency  Hz; decrement: per cycle; loop_area: J/m2
/// `value` is met within the larger of the relative and the absolute tolerance; `above` and `below` are bounds.
Verdict judge(const ExpectSpec& expect, const std::string& name, const Signal& observed, const Signal& against = {});

/// Records what a list of expectations needs. Times count since the last reset of the clock, where recording starts anew.
class Watch {
public:
    /// Throws InputError as make_probe does. Expectations `same_as` a case must have got their value.
    Watch(const std::vector<ExpectSpec>& expects, const Model& model, const State& state);
    bool needs_energies() const;
    /// Once at the start and after every step; gauges may be empty unless needed.
    void record(const Model& model, const State& state, const Gauges& gauges);
    std::vector<Verdict> judge(const Told& told = {}) const;

private:
    struct Watched {
        ExpectSpec expect;
        std::vector<Probe> probes;    // one; two for loop_area; none for what is told
        BlockId block = -1;           // whose mechanism is told
        std::vector<Signal> signals;  // one for each probe
    };
    std::vector<Watched> watched_;
    double last_time_ = 0.0;
};

}  // namespace talus
