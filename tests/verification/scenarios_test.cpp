// The verification scenarios, which state their own sources, formulas and tolerances, and what a scenario cannot state about
// itself: two of its cases compared with each other.
#include "scenario/reader.hpp"
#include "simulation/expect.hpp"
#include "simulation/run.hpp"
#include "support/catch.hpp"

#include <algorithm>
#include <filesystem>

using namespace talus;

namespace {

std::string verification(const std::string& file) {
    return std::string(TALUS_SOURCE_DIR) + "/scenarios/verification/" + file;
}

std::vector<Verdict> verdicts_of(const Scenario& scenario) {
    Simulation simulation(scenario, build(scenario));
    Watch watch(scenario.expect, simulation.model(), simulation.first_state());
    RunOptions options;
    options.watch = &watch;
    CHECK(run(simulation, options) != Outcome::no_equilibrium);
    return watch.judge();
}

}  // namespace

TEST_CASE("every verification scenario meets what it expects") {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(verification(""))) files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    REQUIRE(files.size() >= 26);
    for (const std::string& file : files) {
        for (const Case& row : read_cases(file)) {
            REQUIRE_FALSE(row.scenario.expect.empty());
            for (const Verdict& verdict : verdicts_of(row.scenario)) {
                INFO(file << " / " << row.name << ": " << verdict.what << " is " << verdict.measured << ", expected "
                          << verdict.expected << " within " << verdict.allowed);
                CHECK(verdict.passed);
            }
        }
    }
}

TEST_CASE("a collision seen from a moving frame is the same collision") {
    // Positions of a few metres are rounded to 1e-15 m, which a contact of w = 450 1/s turns into 1e-12 m/s: 1e-9 is far
    // above rounding and far below any dependence of a contact on absolute velocity.
    const std::vector<Case> rows = read_cases(verification("v03_head_on_collision.yaml"));
    REQUIRE(rows.size() == 6);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::vector<Verdict> rest = verdicts_of(rows[i].scenario), moving = verdicts_of(rows[i + 3].scenario);
        for (std::size_t block : {0, 1}) {
            INFO(rows[i].name << ", " << rest[block].what);
            CHECK(std::abs(moving[block].measured - 100.0 - rest[block].measured) < 1e-9);
        }
    }
}
