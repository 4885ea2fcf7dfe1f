// A whole step timed by its parts.
#pragma once

#include "simulation/advance.hpp"

#include <array>
#include <string>
#include <vector>

namespace talus {

struct StepBench {
    std::vector<int> threads{1};
    int steps = 200;   // in a segment
    int repeat = 5;    // segments for each number of threads, in turn with the others
    std::string from;  // the Moment at which timing begins
};

/// ns per block and step, for one number of threads.
struct StepCost {
    int threads = 1;
    /// In the order of part_names. The median over the segments, but the mean for the search: lists of pairs are made in
    /// some segments only.
    std::array<double, part_names.size()> parts{};
    double all = 0.0;            // sum of the parts
    std::int64_t refreshes = 0;  // lists of pairs made in all segments
};

struct StepCosts {
    int blocks = 0, parts = 0;
    std::int64_t contacts = 0;     // that touch, at the end
    double bytes_per_block = 0.0;  // resident, in mid-run, beside what was there before the scene was built
    double build_s = 0.0;          // s, of cutting and model
    std::vector<StepCost> threads;
};

/// Runs on through one simulation: its state does not depend on the number of threads. Throws InputError if the run ends
/// before every segment is complete.
StepCosts time_steps(const Scenario& scenario, const StepBench& bench, const Say& say);

}  // namespace talus
