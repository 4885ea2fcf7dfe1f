#include "simulation/step_bench.hpp"

#include "core/errors.hpp"
#include "core/memory.hpp"
#include "simulation/threads.hpp"

#include <algorithm>
#include <numeric>

namespace talus {
namespace {

using Parts = std::array<double, part_names.size()>;

constexpr int warm_up_steps = 10;  // while memory is got, and the caches of other threads are filled

struct Segment {
    Parts seconds{};
    std::int64_t refreshes = 0;
};

/// Only what happens within steps: the begin of a stage has its own cost.
Segment time_segment(Simulation& simulation, int steps) {
    Segment segment;
    for (int i = 0; i < warm_up_steps + steps; ++i) {
        const Parts before = simulation.seconds();
        const std::int64_t refreshes = simulation.refreshes();
        if (!step_on(simulation))
            throw InputError("steps: the run ends after " + std::to_string(simulation.steps_done()) +
                             " steps, before all segments are timed; ask for fewer, or set run.until.time");
        if (i < warm_up_steps) continue;
        for (std::size_t k = 0; k < before.size(); ++k) segment.seconds[k] += simulation.seconds()[k] - before[k];
        segment.refreshes += simulation.refreshes() - refreshes;
    }
    return segment;
}

StepCost summarise(int threads, const std::vector<Segment>& segments, double blocks_and_steps) {
    StepCost cost;
    cost.threads = threads;
    for (std::size_t k = 0; k < cost.parts.size(); ++k) {
        std::vector<double> seconds;
        for (const Segment& segment : segments) seconds.push_back(segment.seconds[k]);
        std::sort(seconds.begin(), seconds.end());
        const double mean = std::accumulate(seconds.begin(), seconds.end(), 0.0) / static_cast<double>(seconds.size());
        const bool search = k == static_cast<std::size_t>(Part::search);
        cost.parts[k] = 1e9 * (search ? mean : seconds[seconds.size() / 2]) / blocks_and_steps;
        cost.all += cost.parts[k];
    }
    for (const Segment& segment : segments) cost.refreshes += segment.refreshes;
    return cost;
}

}  // namespace

StepCosts time_steps(const Scenario& scenario, const StepBench& bench, const Say& say) {
    for (const int threads : bench.threads) check_threads(threads);
    if (bench.steps < 1) throw InputError("steps: " + std::to_string(bench.steps) + " is not 1 or more");
    if (bench.repeat < 1) throw InputError("repeat: " + std::to_string(bench.repeat) + " is not 1 or more");
    const Moment from(scenario, bench.from);
    const ThreadsKept kept;
    StepCosts costs;
    release_unused_memory();
    const double memory_before = memory_use().now;
    const Stopwatch clock;
    say("building");
    Scene scene = build(scenario);
    costs.build_s = clock.seconds();
    Simulation simulation(scenario, std::move(scene));
    advance_to(simulation, from, say);

    std::vector<std::vector<Segment>> segments(bench.threads.size());
    for (int r = 0; r < bench.repeat; ++r)
        for (std::size_t i = 0; i < bench.threads.size(); ++i) {
            say("segment " + std::to_string(r + 1) + " of " + std::to_string(bench.repeat) + ", " +
                std::to_string(bench.threads[i]) + " threads");
            use_threads(bench.threads[i]);
            segments[i].push_back(time_segment(simulation, bench.steps));
        }

    const Model& model = simulation.model();
    costs.blocks = model.blocks.size();
    costs.parts = model.parts.size();
    const auto& list = simulation.state().contacts.list;
    costs.contacts = std::count_if(list.begin(), list.end(), [](const Contact& c) { return c.touching; });
    costs.bytes_per_block = (memory_use().now - memory_before) / costs.blocks;
    for (std::size_t i = 0; i < bench.threads.size(); ++i)
        costs.threads.push_back(summarise(bench.threads[i], segments[i], static_cast<double>(costs.blocks) * bench.steps));
    return costs;
}

}  // namespace talus
