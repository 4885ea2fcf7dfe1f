// Rounded corners in whole runs: the same bits for every search, number of threads, skin and restart, and a ledger that
// closes.
#include "core/random.hpp"
#include "output/restart.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/whole_run.hpp"

#include <cmath>
#include <vector>

using namespace talus;
using namespace talus::test;

namespace {

// A jointed slope that slides, with stones that fall on it.
const std::string slope = R"(
title: Rounded slope
gravity: [0, -9.81]
materials: {rock: {density: 2500}}
joints: {joint: {normal_stiffness: 1e8, shear_stiffness: 5e7, friction_angle_deg: 15}}
rock:
  outline: [[0, 0], [14, 0], [14, 2], [7, 9], [0, 9]]
  joint_sets:
    - {angle_deg: -30, spacing: 0.9, origin: [14, 2]}
    - {angle_deg: 70, spacing: {mean: 1.1, deviation: 0.2}, seed: 3}
  held: {left: true, bottom: true}
blocks:
  - {name: stone, outline: [[2, 9.1], [2.6, 9.2], [2.4, 9.7]], repeat: {count: 4, step: [1.3, 0.1]}, velocity: [2, -2]}
run: {until: {time: 0.5}, damping: {contact: 4e-4}, rounding_length: 0.02}
)";

template <class AfterStep>
std::vector<std::uint64_t> trace(const Scenario& scenario, AfterStep after_step) {
    return hashes_of(scenario, 100, after_step);
}

const std::vector<std::uint64_t>& reference() {
    static const std::vector<std::uint64_t> found = trace(scenario_of(slope), [](WholeRun&) {});
    return found;
}

}  // namespace

TEST_CASE("rounded: one hash for every search, number of threads and skin") {
    REQUIRE(reference().size() > 5);
    const struct {
        const char* search;
        int threads;
        double skin;  // m
    } choices[] = {{"auto", 2, 0.01}, {"isu", 1, 0.003}, {"dess", 3, 0.3}, {"verlet", 1, 0.0}};
    for (const auto& [search, threads, skin] : choices) {
        Scenario scenario = scenario_of(slope);
        scenario.run.search = search;
        scenario.run.threads = threads;
        scenario.run.skin = skin;
        CAPTURE(search, threads, skin);
        CHECK(trace(scenario, [](WholeRun&) {}) == reference());
    }
}

TEST_CASE("rounded: one hash after restarts and with scratch thrown away") {
    const Folder folder;
    const std::string path = folder / "slope.restart.h5";
    Random random(7);
    int restarts = 0;
    const auto found = trace(scenario_of(slope), [&](WholeRun& r) {
        const std::uint64_t choice = random.bits() % 100;
        if (choice == 1) r.simulation().drop_scratch();
        if (choice != 0) return;
        write_restart(path, RestartInfo{}, r.state());
        r.go_on_from(read_restart(path, r.model()));
        ++restarts;
    });
    CHECK(restarts > 3);
    CHECK(found == reference());
}

TEST_CASE("rounded: the ledger closes, momentum is kept, and friction takes energy") {
    WholeRun run(scenario_of(slope));
    double farthest = 0.0;
    run.to_the_end([&](WholeRun& r) {
        const double scale = r.simulation().energies().gravity + 1.0;
        farthest = std::max(farthest, std::abs(r.simulation().ledger_error()) / scale);
    });
    CHECK(farthest < 1e-10);
    CHECK(run.simulation().energies().friction > 0.0);
    CHECK(run.simulation().energy_gain() < energy_alarm);
}
