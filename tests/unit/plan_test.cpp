// What an accuracy decides, for kinds of scenes; and what it refuses.
#include "simulation/plan.hpp"
#include "core/errors.hpp"
#include "model/hash.hpp"
#include "scenario/reader.hpp"
#include "simulation/error_estimate.hpp"
#include "simulation/run.hpp"
#include "support/catch.hpp"

#include <cmath>
#include <string>

using namespace talus;
using Catch::Matchers::Contains;

namespace {

const std::string scene = R"(
gravity: [0, -9.81]
materials: {rock: {density: 2500}}
joints: {face: {friction_angle_deg: 30}}
blocks:
  - {name: floor, rectangle: {corner: [-4, -1], size: [9, 1]}, held: true}
  - {name: block, rectangle: {corner: [0, 0], size: [1, 1]}, repeat: {count: 3, step: [0, 1]}}
)";
const std::string stiff = "joints.face.normal_stiffness=1e10", shear = "joints.face.shear_stiffness=5e9";

/// `run` without its braces, other sections behind it.
Plan plan(const std::string& run, const std::string& rest = "", const std::vector<std::string>& set = {}) {
    const Scenario scenario = read_scenario_text(scene + "run: {" + run + "}\n" + rest, "f.yaml", ".", set);
    return make_plan(scenario, build(scenario));
}

std::string solver(const std::string& run, const std::string& rest = "", const std::vector<std::string>& set = {}) {
    return plan(run, rest, set).scenario.run.solver;
}

std::string refusal(const std::string& run, const std::string& rest = "", const std::vector<std::string>& set = {}) {
    try {
        plan(run, rest, set);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

const std::string moves = "until: {time: 1}, accuracy: 1e-3";

}  // namespace

TEST_CASE(
    "motion is left to the rigid solver, equilibrium to the static one, and what asks for springs to the explicit one") {
    CHECK(solver(moves) == "rigid");
    CHECK(solver("until: {equilibrium: 1e-6}, accuracy: 1e-3") == "static");
    const std::vector<std::string> given{stiff, shear};
    CHECK(solver("until: {time: 1}, accuracy: {joint_stress: 1e-2}", "", given) == "explicit");
    CHECK(solver("until: {equilibrium: 1e-6}, accuracy: {joint_stress: 1e-2}") == "static");
    CHECK(solver(moves + ", damping: {contact: 1e-3}") == "explicit");
    CHECK(solver(moves, "record: {history: [{joint: [0.5, 0], quantity: normal_stress}]}", given) == "explicit");
    CHECK(solver(moves, "record: {history: [{block: 'block[2]'}]}") == "rigid");
    CHECK(solver(moves, "expect: [{quantity: stable_step, above: 0}]", given) == "explicit");
    CHECK(solver(moves, "expect: [{quantity: energy, component: strain, above: 0}]", given) == "explicit");
    CHECK(solver(moves, "expect: [{quantity: energy, component: kinetic, above: 0}]") == "rigid");
    CHECK(solver(moves, "expect: [{quantity: frequency, component: y, block: 'block[0]', above: 0}]", given) == "explicit");
    CHECK(solver(moves, "", {stiff, shear, "joints.face.dilation_angle_deg=5"}) == "explicit");
    CHECK_THAT(refusal(moves, "", {"joints.face.dilation_angle_deg=5"}),
               Contains("joints.face.normal_stiffness: is missing") && Contains("dilation presses on joints"));
}

TEST_CASE("where what joints close is the answer, their stiffness must be given") {
    const auto refused = [](const std::string& run, const std::string& rest, const std::string& why) {
        CAPTURE(run, rest);
        CHECK_THAT(refusal(run, rest), Contains("f.yaml:4 joints.face.normal_stiffness: is missing (number (Pa/m), > 0: "
                                                "stress per closure): " +
                                                why) &&
                                           Contains("f.yaml:4 joints.face.shear_stiffness: is missing"));
        CHECK(refusal(run, rest, {stiff, shear}) == "accepted");
        CHECK_THAT(refusal(run, rest, {stiff}), !Contains("normal_stiffness") && Contains("joints.face.shear_stiffness"));
    };
    const std::string still = "until: {equilibrium: 1e-6}, accuracy: 1e-2", calm = moves + ", damping: {local: 0.7}";
    const std::string stress = "record: {history: [{joint: [0.5, 0], name: foot}]}";  // forces, opening, slip
    refused(moves, "expect: [{quantity: frequency, component: y, block: 'block[0]', value: 100, tolerance: 0.1}]",
            "an expected frequency depends on the stiffness of joints");
    refused(still, "expect: [{quantity: max_overlap, value: 1e-5, tolerance: 0.1}]", "an expected max_overlap");
    refused(still, "expect: [{quantity: opening, joint: [0.5, 0], below: -1e-6}]", "an expected opening");
    refused(still, "expect: [{quantity: energy, component: strain, value: 1, tolerance: 0.1}]", "an expected energy");
    refused(moves, stress, "normal_stress in foot depends on the stiffness of joints");
    refused("until: {time: 1}, accuracy: {joint_stress: 1e-2}", "", "the stress of joints is asked for");
    refused(calm, stress + "\nbody_acceleration: {time: [0, 1], x: [0, 3], y: [0, 0]}", "normal_stress in foot");
    refused(still, "initial_stress: {k0: 1, left: true}\nrecord: {history: [{block: 'block[0]'}]}",
            "joints under initial stress are loaded or relieved");
    // Forces in equilibrium are what equilibrium makes them, whatever the stiffness.
    for (const std::string& run : {still, calm}) CHECK(refusal(run, stress) == "accepted");
    CHECK(refusal("until: {equilibrium: 1e-6}, accuracy: {joint_stress: 1e-2}", stress) == "accepted");
}

TEST_CASE("a movement that is no more than joints close is not left to rigid ones, nor to a stiffness that is made up") {
    // The top of three blocks sinks by about rho g (3 + 2 + 1) / kn = 1.5e-3 m at 1e8 Pa/m.
    const auto sinks = [](const std::string& by) {
        return "expect: [{quantity: displacement, component: y, block: 'block[2]', value: " + by + ", tolerance: 0.1}]";
    };
    const std::vector<std::string> soft{"joints.face.normal_stiffness=1e8", "joints.face.shear_stiffness=1e8"};
    CHECK(solver(moves, sinks("-1.5e-3"), soft) == "explicit");
    CHECK(solver(moves, sinks("-0.15"), soft) == "rigid");
    const std::string still = "until: {equilibrium: 1e-6}, accuracy: 1e-2";
    CHECK_THAT(refusal(still, sinks("-1.5e-3")), Contains("joints.face.normal_stiffness: is missing") &&
                                                     Contains("an expected displacement of -0.0015 m is no more than"));
    CHECK(refusal(still, "expect: [{quantity: max_displacement, below: 1e-3}]") == "accepted");
}

TEST_CASE("blocks that fly rebound by their springs, unless a restitution is stated") {
    const std::vector<std::string> above{"blocks[1].rectangle.corner=[0, 0.5]"},
        tilted{"blocks[1].rectangle.angle_deg=5", "blocks[1].repeat.count=1"};
    CHECK(solver(moves, "", above) == "explicit");
    CHECK(solver(moves, "", tilted) == "rigid");  // it stands on a corner
    for (const char* stated : {"0", "0.001", "0.5"})
        CHECK(solver(moves, "", {above[0], "joints.face.restitution=" + std::string(stated)}) == "rigid");
    const Plan open = plan(moves, "", above);
    REQUIRE(open.warnings.size() == 1);
    CHECK_THAT(open.warnings[0], Contains("state a restitution of the joints"));
    CHECK(plan(moves + ", damping: {contact: 1e-4}", "", above).warnings.empty());
    CHECK_THAT(refusal(moves, "expect: [{quantity: energy, component: strain, above: 0}]", {"joints.face.restitution=0.5"}),
               Contains("f.yaml:8 run.accuracy: 0.001 cannot be reached: a restitution is for the rigid solver"));
}

TEST_CASE("a key that is given goes before the accuracy, and without an accuracy nothing is chosen") {
    const Plan given = plan(moves + ", time_step: 0.05, freeze: never");
    CHECK(given.scenario.run.time_step == 0.05);
    CHECK_FALSE(given.scenario.run.freeze);
    REQUIRE(given.warnings.size() == 1);
    CHECK_THAT(given.warnings[0], Contains("time_step of run is 0.05 s"));
    const Plan open = plan("until: {time: 1}", "", {stiff, shear});
    CHECK(open.choices.empty());
    CHECK(open.scenario.run.solver == "auto");
    CHECK(open.scenario.run.step_fraction == 0.8);
}

TEST_CASE("a joint whose stiffness is left open closes by no more than the accuracy allows") {
    const Plan at_rest = plan("until: {equilibrium: 1e-6}, accuracy: 1e-3");
    const double kn = at_rest.scenario.joints[0].normal_stiffness;
    const double settlement = 2500.0 * 9.81 * (3.0 + 2.0 + 1.0) / kn;  // of the top of three blocks of 1 m
    CHECK(settlement < 1e-3);
    CHECK(settlement > 1e-10);  // what coordinates of some metres resolve
    CHECK(at_rest.scenario.joints[0].shear_stiffness == 0.5 * kn);
    CHECK(plan("until: {equilibrium: 1e-6}, accuracy: 1e-3", "", {stiff}).scenario.joints[0].normal_stiffness == 1e10);
}

TEST_CASE("a jump of a table is met to within the accuracy, however short the jump is") {
    const std::string pulse = "body_acceleration: {time: [0, 0.2, 0.2000001], x: [3, 3, 0], y: [0, 0, 0]}\n";
    // A pulse of 0.2 s that ends up to half a step early or late is wrong by step / 0.4 s.
    CHECK(*plan(moves, pulse).scenario.run.time_step <= 0.4e-3);
    const std::string ramp = "body_acceleration: {time: [0, 0.5, 1], x: [0, 3, 0], y: [0, 0, 0]}\n";
    CHECK(*plan(moves, ramp).scenario.run.time_step > 1e-3);
}

TEST_CASE("an accuracy that cannot be reached is refused with the reason and with what can be reached") {
    const std::string soft = refusal("until: {time: 1}, accuracy: 1e-5, solver: explicit", "", {stiff, shear});
    // Top of three blocks: about rho g (3 + 2 + 1) / kn = 1.5e-5 m.
    CHECK_THAT(soft, Contains("f.yaml:8 run.accuracy: 1e-05 cannot be reached: solver: explicit is given (run)") &&
                         Contains("joints of 1e+10 Pa/m") && Contains("could be") && Contains("joint_stress"));
    CHECK_THAT(refusal("until: {time: 1}, accuracy: 1e-9"), Contains("1e-06 can be reached"));
    CHECK_THAT(refusal("until: {time: 1}, accuracy: 1e-9, solver: explicit", "", {stiff, shear}),
               Contains("1e-06 can be reached"));
    CHECK_THAT(refusal(moves + ", damping: {contact: 1e-3}", "", {stiff, shear}), Contains("damping is given (run)"));
    CHECK_THAT(refusal("until: {time: 1}, accuracy: {joint_stress: 0.01}, solver: rigid"),
               Contains("f.yaml:8 run.accuracy.joint_stress: the rigid solver finds one of the states"));
    CHECK_THAT(refusal("until: {time: 1}, accuracy: 0.5"), Contains("f.yaml:8 run.accuracy: "));
    CHECK_THAT(refusal("until: {time: 1}, accuracy: 0"), Contains("f.yaml:8 run.accuracy: "));
    CHECK_THAT(refusal("until: {time: 1}, accuracy: {}"), Contains("needs at least one of motion, joint_stress"));
    CHECK_THAT(refusal("until: {time: 1}"), Contains("f.yaml:4 joints.face.normal_stiffness: is missing") &&
                                                Contains("f.yaml:4 joints.face.shear_stiffness: is missing"));
}

TEST_CASE("a run that an accuracy has decided goes on bit for bit from a saved state") {
    const Scenario scenario = read_scenario_text(scene + "run: {until: {time: 0.2}, accuracy: 1e-3}\n", "f.yaml", ".",
                                                 {"blocks[1].rectangle.angle_deg=5", "blocks[1].repeat.count=1"});
    Simulation whole(scenario, build(scenario));
    whole.begin_stage();
    for (int i = 0; i < 40; ++i) whole.step();
    Simulation second(scenario, build(scenario), whole.state());
    while (!whole.stage_over()) whole.step(), second.step();
    CHECK(state_hash(whole.model(), whole.state()) == state_hash(second.model(), second.state()));
}

TEST_CASE("the estimate of an error is the error, for a block on a spring") {
    // Gravity is switched on at once: y = -(g / omega^2) (1 - cos omega t), omega^2 = kn L / m = 1e8 / 2500 per s2. With
    // steps of 0.1 / omega leapfrog is wrong by (omega dt)^2 / 24 in the phase, ten swings long.
    const double omega = 200.0, t = 0.31, g = 9.81;
    const std::string text =
        scene +
        "run: {until: {time: 0.31}, time_step: 5e-4, solver: explicit}\n"
        "expect: [{quantity: displacement, component: y, block: 'block[0]', value: 0, tolerance_absolute: 1}]\n";
    const Scenario scenario = read_scenario_text(
        text, "f.yaml", ".",
        {"joints.face.normal_stiffness=1e8", "joints.face.shear_stiffness=1e8", "blocks[1].repeat.count=1"});
    Simulation simulation(scenario, build(scenario));
    Watch watch(watched_for_error(scenario), simulation.model(), simulation.first_state());
    std::vector<double> steps;
    RunOptions options;
    options.watch = &watch;
    options.stage_begun = [&](const Simulation& s) { steps.push_back(s.state().stage_step); };
    run(simulation, options);
    const ErrorEstimate estimate = estimate_error(simulation, steps, watch.judge());
    REQUIRE(estimate.of.size() == 2);
    const double exact = -(g / (omega * omega)) * (1.0 - std::cos(omega * t));
    CHECK(estimate.of[1].error == Approx(std::abs(estimate.of[1].value - exact)).epsilon(0.1));
}
