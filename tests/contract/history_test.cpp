// Rows of histories: when they are due, whatever stages there are, and in a run that is stopped and resumed.
#include "output/output_path.hpp"
#include "output/reader.hpp"
#include "simulation/run.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/whole_run.hpp"

#include <cmath>
#include <vector>

using namespace talus;
using namespace talus::test;

namespace {

const std::string block = R"(
gravity: [0, -9.81]
materials: {rock: {density: 2500}}
joints: {plane: {normal_stiffness: 1e8, shear_stiffness: 5e7, friction_angle_deg: 20}}
blocks:
  - {name: plane, rectangle: {corner: [-2, -1], size: [9, 1]}, held: true}
  - {name: block, rectangle: {corner: [-0.5, 0], size: [1, 1]}, velocity: [1, 0]}
)";

const std::string rest_first = R"(
stages: [{name: rest, solver: static, until: {equilibrium: 1e-6}}]
record: {history: [{name: h, every: 0.01, point: [0, 0.5], quantity: displacement, component: y}]}
run: {until: {time: 0.05}}
)";

void go_on(Simulation& simulation, const std::string& path, const RestartInfo& info) {
    Recorder recorder(path, simulation, info);
    RunOptions options;
    options.recorder = &recorder;
    options.entry = Entry::resumed;
    run(simulation, options);
    recorder.finish(simulation, "complete", 0.0);
}

/// Writes a run, of which no more than `steps` are done before it is stopped and resumed; 0: not stopped.
Table history(const std::string& text, const std::string& path, int steps) {
    const Scenario scenario = scenario_of(block + text);
    RunOptions options;
    int done = 0;
    if (steps > 0) options.interrupted = [&] { return done++ == steps; };
    {
        Simulation simulation(scenario, build(scenario));
        simulation.begin_stage();
        Recorder recorder(path, simulation, std::vector<std::string>{});
        options.recorder = &recorder;
        options.entry = Entry::begun;
        const Outcome outcome = run(simulation, options);
        recorder.finish(simulation, outcome == Outcome::interrupted ? "interrupted" : "complete", 0.0);
    }
    if (steps > 0) {
        const RestartInfo info = read_restart_info(restart_path(path));
        Scene scene = build(scenario);
        State state = read_restart(restart_path(path), scene.model);
        Simulation simulation(scenario, std::move(scene), std::move(state));
        go_on(simulation, path, info);
    }
    return ResultsReader(path).history("h");
}

}  // namespace

TEST_CASE("a history has each of its rows once, also behind a static stage that is recorded") {
    const Folder folder;
    const Table rows = history(rest_first, folder / "run.h5", 0);
    REQUIRE(rows.rows() == 6);
    for (std::size_t k = 0; k < rows.rows(); ++k) CHECK(std::abs(rows.values[0][k] - 0.01 * static_cast<double>(k)) < 1e-3);
    // Of what rests on its joint: the block sinks by rho g / kn.
    CHECK(rows.values[1][0] == Approx(-2500.0 * 9.81 / 1e8).epsilon(1e-4));
}

TEST_CASE("a run that is stopped anywhere and resumed writes the rows of one that is not") {
    const Folder folder;
    const std::string memory =
        "record: {frames: {count: 3}, history: [{name: h, every: 0.02, quantities: [energy_drift, slip_changes, energy]}]}\n"
        "run: {until: {time: 0.4}}\n";
    for (const std::string& text : {rest_first, memory}) {
        const Table whole = history(text, folder / "whole.h5", 0);
        REQUIRE(whole.rows() > 5);
        for (const int steps : {1, 2, 5, 60}) {
            const Table resumed = history(text, folder / ("resumed " + std::to_string(steps) + ".h5"), steps);
            CHECK(resumed.values == whole.values);
        }
    }
}

TEST_CASE("a run that is resumed where its static stage has ended does not record that end again") {
    const Folder folder;
    const std::string path = folder / "run.h5";
    const std::string text =
        "record: {history: [{name: h, point: [0, 0.5], quantity: displacement, component: y}]}\n"
        "run: {solver: static, until: {equilibrium: 1e-6}}\n";
    REQUIRE(history(text, path, 0).rows() == 1);
    const Scenario scenario = scenario_of(block + text);
    const RestartInfo info = read_restart_info(restart_path(path));
    Scene scene = build(scenario);
    State state = read_restart(restart_path(path), scene.model);
    Simulation simulation(scenario, std::move(scene), std::move(state));
    go_on(simulation, path, info);
    CHECK(ResultsReader(path).history("h").rows() == 1);
    CHECK(ResultsReader(path).frames() == 2);  // as it is drawn, and at rest
}
