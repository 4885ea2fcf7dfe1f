// Scenarios that are run for what they expect: numbers of other cases, faults and warnings; and the guard against blocks
// that pass through each other.
#include "simulation/trial.hpp"
#include "scenario/reader.hpp"
#include "simulation/deep_overlap.hpp"
#include "support/catch.hpp"

#include <map>
#include <string>

using namespace talus;

namespace {

// A cube of 1 m flies at a wall: kn L = 1e9 N/m stop 2500 kg within v sqrt(m/k) = 1.58e-3 v.
const std::string shot = R"(
materials: {rock: {density: 2500}}
joints: {wall: {normal_stiffness: 1e9, shear_stiffness: 1e8}}
blocks:
  - {name: wall, rectangle: {corner: [0, -1], size: [1, 3]}, held: true}
  - {name: cube, rectangle: {corner: [-1.001, 0], size: [1, 1]}, velocity: [10, 0]}
run: {until: {time: 0.1}, step_fraction: 0.1}
)";

std::vector<Case> cases(const std::string& text) { return read_cases_text(shot + text, "shot.yaml", "."); }

Trial only(const std::string& text) { return try_out(cases(text).front().scenario); }

}  // namespace

TEST_CASE(
    "a block that its joint stops in time comes back, and one that it cannot stop ends the run with the stiffness it "
    "needs") {
    CHECK(only("expect: [{quantity: velocity, component: x, block: cube, value: -10, tolerance: 0.01}]").passed());
    const std::string fast = "cases: [{set: {\"blocks[1].velocity\": [1000, 0], run.until.time: 0.01}, expect: [";
    CHECK_FALSE(only(fast + "{quantity: max_speed, at: max, above: 0}]}]").passed());
    const Trial told = only(fast +
                            "{quantity: fault, says: \"between block 0 `wall` and block 1 `cube`\"}, "
                            "{quantity: fault, says: would keep it near 1 %}, "
                            "{quantity: position, component: x, block: cube, at: max, below: 0.3}]}]");
    for (const Verdict& verdict : told.verdicts) CHECK(verdict.passed);
    CHECK(told.passed());
    CHECK(only("cases: [{set: {\"blocks[1].velocity\": [1000, 0], run.until.time: 0.01, run.unchecked: true}, "
               "expect: [{quantity: position, component: x, block: cube, above: 2}]}]")
              .passed());  // who asks for it may watch
}

TEST_CASE("the deepest overlap is the way that would part the two, not a mean") {
    Scenario scenario = cases("").front().scenario;
    scenario.gravity = {};
    Simulation simulation(scenario, build(scenario));
    simulation.begin_stage();
    double deepest = 0.0, farthest = -1.0;
    while (!simulation.stage_over()) {
        simulation.step();
        const DeepOverlap found = deepest_overlap(simulation.model(), simulation.placed(), simulation.state());
        deepest = std::max(deepest, found.share());
        farthest = std::max(farthest, simulation.state().motion.position[1].x() + 0.5);
        if (found.contact) CHECK(found.room == 0.75);
    }
    CHECK(deepest == Approx(farthest).epsilon(1e-9));  // both are 1 m thick
    CHECK(deepest == Approx(0.0158).epsilon(0.02));    // 10 m/s x sqrt(2500 kg / 1e9 N/m)
}

TEST_CASE("overlaps are looked at before anything can have come a quarter of the thinnest block closer") {
    for (const double speed : {0.0, 0.01, 1.0, 20.0}) {
        int since = 0, most = 0;
        for (int step = 1; step <= 2000; ++step) {
            most = std::max(most, ++since);
            if (time_to_look(step, speed, 1e-3, 0.1)) since = 0;
        }
        CHECK(most <= 128);
        CHECK((most == 1 || 2.0 * speed * 1e-3 * most <= 0.25 * 0.1));  // both blocks at this speed
        if (speed == 0.0) CHECK(most == 128);
    }
}

TEST_CASE("a value may be that of an earlier case, at the same place of its list") {
    const std::string rows = R"(
cases:
  - {name: first, expect: [{quantity: max_speed, above: 0}, {quantity: velocity, component: x, block: cube, below: 0}]}
  - name: second
    set: {"blocks[1].velocity": [5, 0]}
    expect:
      - {quantity: max_speed, above: 0}
      - {quantity: velocity, component: x, block: cube, same_as: first, tolerance: 0.01}
)";
    const std::vector<Case> both = cases(rows);
    std::map<std::string, Trial> tried;
    tried["first"] = try_out(both[0].scenario);
    const Trial half = try_out(both[1].scenario, tried);
    REQUIRE(half.verdicts.size() == 2);
    CHECK(half.verdicts[0].passed);
    CHECK_FALSE(half.verdicts[1].passed);
    CHECK(half.verdicts[1].expected == tried["first"].verdicts[1].measured);
    CHECK(half.verdicts[1].measured == Approx(-5.0).epsilon(0.01));
    CHECK_FALSE(try_out(both[1].scenario).passed());  // nothing to compare with
}

TEST_CASE("a case that is not there, or expects nothing at this place, cannot be compared with") {
    const std::string row = "  - {name: b, expect: [{quantity: max_speed, same_as: a, tolerance: 0}]}\n";
    CHECK_THROWS_WITH(cases("cases:\n" + row), Catch::Contains("no case `a` above"));
    CHECK_THROWS_WITH(cases("cases:\n" + row + "  - {name: a, expect: [{quantity: max_speed, above: 0}]}\n"),
                      Catch::Contains("no case `a` above"));
    CHECK_THROWS_WITH(cases("cases:\n  - {name: a, expect: []}\n" + row), Catch::Contains("no case `a` above"));
    CHECK_NOTHROW(cases("cases:\n  - {name: a, expect: [{quantity: max_speed, above: 0}]}\n" + row));
    CHECK_THROWS_WITH(cases("expect: [{quantity: max_speed, same_as: a}]"), Catch::Contains("needs tolerance"));
}

TEST_CASE("an expected fault is no trouble; one that nobody expected is, and so is one of other words") {
    const std::string refused = "cases: [{set: {\"blocks[1].rectangle.corner\": [-0.5, 0]}, expect: [";
    CHECK(only(refused + "{quantity: fault, says: \"block `cube` overlaps block `wall` by 0.5 m\"}]}]").passed());
    CHECK_FALSE(only(refused + "{quantity: fault, says: something else}]}]").passed());
    const Trial unexpected = only(refused + "{quantity: max_speed, below: 100}]}]");
    CHECK(unexpected.trouble.find("overlaps") != std::string::npos);
    CHECK_FALSE(unexpected.verdicts[0].passed);
    CHECK_FALSE(only("expect: [{quantity: fault, says: anything}]").passed());  // it came to its end
}

TEST_CASE("warnings can be expected, those of the scene and those of the run") {
    CHECK(only("expect: [{quantity: warning, says: share no edge with another}]").passed());
    CHECK_FALSE(only("expect: [{quantity: warning, says: gained energy from nowhere}]").passed());
    // Deep, but not too deep: 100 m/s are stopped within 0.158 m, and the run ends at that moment.
    CHECK(only("cases: [{set: {\"blocks[1].velocity\": [100, 0], run.until.time: 0.0025}, "
               "expect: [{quantity: warning, says: \"of the thinner part (1 m)\"}]}]")
              .passed());
}

TEST_CASE("words belong to faults and warnings, which take no number") {
    CHECK_THROWS_WITH(cases("expect: [{quantity: fault}]"), Catch::Contains("is missing: words of the text"));
    CHECK_THROWS_WITH(cases("expect: [{quantity: warning, says: a, below: 1}]"), Catch::Contains("takes no value"));
    CHECK_THROWS_WITH(cases("expect: [{quantity: max_speed, says: a, below: 1}]"),
                      Catch::Contains("goes with fault and warning"));
}

TEST_CASE("areas, overlaps, changes of slip and energy from nowhere are numbers of the scene") {
    // A block of 2 x 1 m on a floor is pushed to and fro by 1.5 of its friction: it begins and ceases to slide at each turn.
    const Trial trial = try_out(read_scenario_text(R"(
gravity: [0, -10]
materials: {rock: {density: 1000}}
joints: {rough: {normal_stiffness: 1e8, shear_stiffness: 1e8, friction_angle_deg: 45}}
blocks:
  - {name: floor, rectangle: {corner: [-9, -1], size: [18, 1]}, held: true}
  - {name: block, rectangle: {corner: [0, 0], size: [2, 1]}}
loads: [{block: block, force: {time: [1, 1.001, 1.1, 1.101, 2, 2.001, 2.1, 2.101], x: [0, 3e4, 3e4, 0, 0, -3e4, -3e4, 0], y: [0, 0, 0, 0, 0, 0, 0, 0]}}]
run: {until: {time: 4}, damping: {contact: 2e-3}}
expect:
  - {quantity: area, value: 20, tolerance: 1e-14}
  - {quantity: area, block: block, value: 2, tolerance: 1e-14}
  - {quantity: max_overlap, value: 1e-4, tolerance: 0.01}
  - {quantity: slip_changes, at: 0.9, value: 0, tolerance_absolute: 0}
  - {quantity: slip_changes, above: 3.5}
  - {quantity: slip_changes, below: 20}
  - {quantity: energy_gain, below: 0.01}
)",
                                                   "push.yaml", "."));
    for (const Verdict& verdict : trial.verdicts) {
        INFO(verdict.what << " is " << verdict.measured);
        CHECK(verdict.passed);
    }
}
