// Whoever states an accuracy and leaves the rest to Talus gets it: scenes with closed forms, those of the charts.
#include "scenario/reader.hpp"
#include "simulation/trial.hpp"
#include "support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

using namespace talus;

namespace {

struct Exact {
    double value, scale;  // the error is that of `value` over `scale`
};

/// Largest error of a scene of scenarios/accuracy. Damping goes: it is there for springs.
double error(const std::string& file, double accuracy, std::vector<std::string> set, const std::vector<Exact>& exact) {
    set.push_back("run.accuracy=" + std::to_string(accuracy));
    const Trial trial = try_out(read_scenario(std::string(TALUS_SOURCE_DIR) + "/scenarios/accuracy/" + file, set));
    CAPTURE(trial.trouble);
    REQUIRE(trial.verdicts.size() == exact.size());
    double most = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i)
        most = std::max(most, std::abs(trial.verdicts[i].measured - exact[i].value) / exact[i].scale);
    return most;
}

const std::string undamped = "run.damping={}";

const std::string falling = R"(
gravity: [0, -9.81]
materials: {rock: {density: 2600}}
joints: {j: {friction_angle_deg: 30, restitution: 0}}
blocks:
  - {name: floor, rectangle: {corner: [-5, -1], size: [10, 1]}, held: true}
  - {name: block, rectangle: {corner: [0, 1], size: [1, 0.5]}}
run: {until: {time: 1}}
expect: [{quantity: displacement, component: y, block: block, value: -1, tolerance: 0.01}]
)";

void holds(const std::string& file, const std::vector<std::string>& set, const std::vector<Exact>& exact,
           const std::vector<double>& levels = {1e-2, 1e-3}) {
    for (const double accuracy : levels) {
        CAPTURE(file, accuracy);
        CHECK(error(file, accuracy, set, exact) <= accuracy);
    }
}

/// Housner's block by quadrature, 1 x 4 m from half of its critical tilt: it swings to the other side by so much of a
/// radian.
constexpr double rocking_amplitude = 0.094737, rocking_swing = 0.217226;

}  // namespace

TEST_CASE("a block slides as far as Coulomb says, to the accuracy asked for") {
    holds("incline.yaml", {}, {{0.906407364, 0.906407364}}, {1e-2, 1e-3, 1e-4});
    // With joints whose stiffness nobody gives, and other angles: g (sin a - cos a tan phi) / 2.
    holds("incline.yaml", {"joints.plane={friction_angle_deg: 20}", "initial_stress.joints=[]"},
          {{0.906407364, 0.906407364}}, {1e-2, 1e-3, 1e-4});
}

TEST_CASE("a block whose joints state that nothing rebounds lies where it fell, to the accuracy asked for") {
    for (const double accuracy : {1e-2, 1e-3, 1e-4}) {
        CAPTURE(accuracy);
        const Trial trial =
            try_out(read_scenario_text(falling, "f.yaml", ".", {"run.accuracy=" + std::to_string(accuracy)}));
        REQUIRE(trial.verdicts.size() == 1);
        CHECK(trial.solver == "rigid");
        CHECK(trial.verdicts[0].measured == Approx(-1.0).epsilon(accuracy));
    }
}

TEST_CASE("a shaken block slips as far as Newmark says, to the accuracy asked for") {
    holds("newmark_block.yaml", {}, {{-0.168000015, 0.168}}, {1e-2, 1e-3, 1e-4});
    // The pulse one part in three longer: D = (A T)^2 / (2 g N) (1 - N / A).
    const double t = 0.2849, slip = std::pow(4.905 * t, 2) / (2.0 * 9.81 * 0.2) * (1.0 - 0.4);
    holds("newmark_block.yaml",
          {"body_acceleration={time: [0, 0.2849, 0.28490001], x: [-4.905, -4.905, 0], y: [0, 0, 0]}", "run.until.time=1.2"},
          {{-slip, slip}});
}

TEST_CASE("a block rocks as far as Housner says, to the accuracy asked for") {
    holds("rocking_block.yaml", {undamped}, {{-rocking_swing, rocking_amplitude}}, {1e-2, 1e-3, 1e-4});
}

TEST_CASE("a stack, an arch and a slope stand where they were built, to the accuracy asked for") {
    // The file asks by how much the joints close; here that is error.
    const std::string stands =
        "expect=[{quantity: displacement, component: y, block: top, value: 0, tolerance_absolute: 1}, "
        "{quantity: displacement, component: x, block: top, value: 0, tolerance_absolute: 1}]";
    holds("stack.yaml", {undamped, "run.until.time=2", stands}, {{0.0, 1.0}, {0.0, 1.0}}, {1e-2, 1e-3, 1e-4});
    holds("stack.yaml", {"run={until: {equilibrium: 1e-8}}", "joints.face={friction_angle_deg: 30}", stands},
          {{0.0, 1.0}, {0.0, 1.0}}, {1e-2, 1e-3, 1e-4});
    holds("arch.yaml", {undamped, "run.until.time=1"}, {{0.0, 1.2}});
    holds("arch.yaml", {"run={until: {equilibrium: 1e-8}}", "joints.mortarless={friction_angle_deg: 35}"}, {{0.0, 1.2}});
    holds("jointed_mass.yaml", {undamped, "run.until.time=0.1"}, {{0.0, 1.3}}, {1e-2});
}

TEST_CASE("a bonded wedge slides as one body while the rock below stays, to the accuracy asked for") {
    holds("sliding_wedge.yaml", {undamped}, {{0.940144, 0.940144}, {0.0, 0.940144}});
}

TEST_CASE("corners that hit keep their energy, to the accuracy asked for") {
    holds("corner_impacts.yaml", {}, {{90000.0, 90000.0}});
    holds("corner_impacts.yaml", {"joints.floor.restitution=1"}, {{90000.0, 90000.0}});
}

TEST_CASE("an oscillation has its period, to the accuracy asked for") {
    // 1 m2 of 2500 kg on a joint of 1e8 Pa/m over 2 m: omega^2 = 2e8 / 2500.
    const std::vector<std::string> spring{
        "joints.plane.normal_stiffness=1e8",
        "joints.plane.shear_stiffness=1e8",
        "run.until.time=0.5",
        "initial_stress.joints=[]",
        "blocks[0].rectangle={corner: [0, -1], size: [6, 1]}",
        "blocks[1].rectangle={corner: [1, 0], size: [2, 0.5]}",
        "expect=[{quantity: frequency, component: y, block: block, value: 45, tolerance: 1}]"};
    const double frequency = std::sqrt(2e8 / 2500.0) / (2.0 * M_PI);
    holds("incline.yaml", spring, {{frequency, frequency}});
}
