// The scenarios that state their own sources, formulas and tolerances: those of verification, and those where methods of
// this kind are known to fail.
#include "scenario/reader.hpp"
#include "simulation/expect.hpp"
#include "simulation/run.hpp"
#include "simulation/trial.hpp"
#include "support/catch.hpp"

#include <algorithm>
#include <filesystem>
#include <set>

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
    const Outcome outcome = run(simulation, options);
    if (std::ranges::none_of(scenario.expect,
                             [](const ExpectSpec& e) { return e.probe.quantity == "equilibrium" || about_the_verdict(e); }))
        CHECK(outcome != Outcome::no_equilibrium);
    Told told;
    told.verdict = simulation.verdict();
    return watch.judge(told);
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

TEST_CASE("where methods of this kind fail, Talus does not, or says so") {
    // Those that take seconds for a case are left to `talus verify scenarios/stability`: a million steps, ten thousand
    // blocks, many threads.
    const std::set<std::string> slow{"f04", "f09", "f10", "f11", "f12", "f16", "f21", "f25", "n11"};
    const std::string folder = std::string(TALUS_SOURCE_DIR) + "/scenarios/stability";
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::string name = entry.path().stem().string();
        if (slow.contains(name.substr(0, 3))) continue;
        ++files;
        std::map<std::string, Trial> tried;
        for (const Case& row : read_cases(entry.path().string())) {
            const Trial& trial = tried[row.name] = try_out(row.scenario, tried);
            for (const Verdict& verdict : trial.verdicts) {
                INFO(name << " / " << row.name << ": " << verdict.what << " is " << verdict.measured << ", " << verdict.asked
                          << ' ' << verdict.expected << " within " << verdict.allowed);
                CHECK(verdict.passed);
            }
            INFO(name << " / " << row.name << ": " << trial.trouble);
            CHECK(trial.passed());
        }
    }
    CHECK(files >= 18);
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
