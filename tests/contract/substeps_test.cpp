// Small blocks that take several steps in one step of the others: the same bits for every search, number of threads and
// restart, closed forms, what is conserved, and what happens beyond the limit.
#include "core/errors.hpp"
#include "core/random.hpp"
#include "output/restart.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/whole_run.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace talus;
using namespace talus::test;

namespace {

// Blocks of 1 m that fall on a layer of pieces of 3 cm and sweep them aside; `rest`: of `run`.
Scenario rubble(const std::string& rest) {
    return scenario_of(R"(
title: Rubble
gravity: [0, -10]
materials: {rock: {density: 2500}}
joints: {joint: {normal_stiffness: 1e8, shear_stiffness: 5e7, friction_angle_deg: 30}}
blocks:
  - {name: floor, held: true, rectangle: {corner: [-1, -1], size: [9, 1]}}
  - {name: wall, held: true, rectangle: {corner: [-1, 0], size: [0.95, 3]}}
  - {name: piece, rectangle: {corner: [0, 0], size: [0.03, 0.024]}, repeat: {count: 60, step: [0.06, 0]}}
  - {name: upper, rectangle: {corner: [0.02, 0.024], size: [0.027, 0.03]}, repeat: {count: 30, step: [0.12, 0]}}
  - {name: large, rectangle: {corner: [0.1, 0.07], size: [1.2, 1]}, velocity: [0.5, -1], repeat: {count: 3, step: [1.4, 0.05]}}
  - {name: far, rectangle: {corner: [5.5, 0], size: [1, 1]}, repeat: {count: 2, step: [0.02, 1]}}
run: {until: {time: 0.3}, )" +
                       rest + "}\n");
}

// Bonded slabs of 8 mm between blocks of 1 m, three of each, on a held base.
Scenario column(const std::string& rest) {
    return scenario_of(R"(
title: Column of slabs and blocks
gravity: [0, -10]
materials: {rock: {density: 2500}}
joints: {bonded: {normal_stiffness: 1e9, shear_stiffness: 1e9, friction_angle_deg: 30, tension: 1e9, cohesion: 1e9}}
blocks:
  - {name: base, held: true, rectangle: {corner: [0, -1], size: [1, 1]}}
  - {name: slab, rectangle: {corner: [0, 0], size: [1, 0.008]}, repeat: {count: 3, step: [0, 1.008]}}
  - {name: block, rectangle: {corner: [0, 0.008], size: [1, 1]}, repeat: {count: 3, step: [0, 1.008]}}
run: )" + rest + "\n");
}

// m, how far the topmost block of that column is from its place at t: masses on springs that are loaded all at once.
double top_in_closed_form(double t) {
    constexpr int n = 6;
    constexpr double kn = 1e9, g = 10.0;
    Eigen::VectorXd mass(n);
    mass << 20.0, 2500.0, 20.0, 2500.0, 20.0, 2500.0;
    Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < n; ++i) {
        k(i, i) += kn;
        if (i == 0) continue;
        k(i - 1, i - 1) += kn;
        k(i, i - 1) -= kn;
        k(i - 1, i) -= kn;
    }
    const Eigen::VectorXd root = mass.cwiseSqrt().cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(root.asDiagonal() * k * root.asDiagonal());
    const Eigen::VectorXd force = modes.eigenvectors().transpose() * root.cwiseProduct(-g * mass);
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
        const double omega2 = modes.eigenvalues()[i];
        sum += modes.eigenvectors()(n - 1, i) * force[i] / omega2 * (1.0 - std::cos(std::sqrt(omega2) * t));
    }
    return sum * root[n - 1];
}

double top_moved(const WholeRun& run) {
    const BlockId top = run.model().blocks.size() - 1;
    return run.state().motion.position[top].y() - run.state().start_position[top].y();
}

double error_of_column(const std::string& steps, double t, double& step) {
    WholeRun run(column("{until: {time: " + std::to_string(t) + "}, " + steps + "}"));
    run.to_the_end();
    REQUIRE(run.state().substeps == 4);
    step = run.state().stage_step;
    return std::abs(top_moved(run) - top_in_closed_form(t));
}

int fast_blocks(const State& state) { return static_cast<int>(std::count(state.fast.begin(), state.fast.end(), 1)); }

template <class AfterStep>
std::vector<std::uint64_t> trace(const Scenario& scenario, AfterStep after_step) {
    return hashes_of(scenario, 20, after_step);
}

const char* const choices_of_run[] = {"substeps: 4", "substeps: 4, damping: {local: 0.3}, freeze: 0.02",
                                      "substeps: 2, damping: {contact: 1e-4}, freeze: 0.05"};

}  // namespace

TEST_CASE("small pieces are fast, blocks that are thirty times larger are not, and held ones neither") {
    WholeRun run(rubble("substeps: 4"));
    run.simulation().begin_stage();
    const State& state = run.state();
    REQUIRE(state.substeps == 4);
    for (BlockId b = 0; b < run.model().blocks.size(); ++b) CHECK(state.is_fast(b) == (run.model().blocks.area[b] < 0.1));
    CHECK(fast_blocks(state) == 90);
}

TEST_CASE("one hash with substeps, for every search, number of threads and skin") {
    const struct {
        const char* search;
        int threads;
        double skin;  // m
    } others[] = {{"auto", 2, 0.01}, {"isu", 1, 0.0005}, {"dess", 1, 0.3}};
    for (const char* of_run : choices_of_run) {
        const std::vector<std::uint64_t> reference = trace(rubble(of_run), [](WholeRun&) {});
        REQUIRE(reference.size() > 5);
        for (const auto& [search, threads, skin] : others) {
            Scenario scenario = rubble(of_run);
            scenario.run.search = search;
            scenario.run.threads = threads;
            scenario.run.skin = skin;
            CAPTURE(of_run, search, threads, skin);
            CHECK(trace(scenario, [](WholeRun&) {}) == reference);
        }
    }
}

TEST_CASE("one hash with substeps after restarts and with scratch thrown away") {
    const Folder folder;
    const std::string path = folder / "rubble.restart.h5";
    for (const char* of_run : choices_of_run) {
        Random random(5);
        int restarts = 0;
        const auto hashes = trace(rubble(of_run), [&](WholeRun& r) {
            const std::uint64_t choice = random.bits() % 20;
            if (choice == 1) r.simulation().drop_scratch();
            if (choice != 0) return;
            write_restart(path, RestartInfo{}, r.state());
            r.go_on_from(read_restart(path, r.model()));
            ++restarts;
        });
        CAPTURE(of_run);
        CHECK(restarts > 2);
        CHECK(hashes == trace(rubble(of_run), [](WholeRun&) {}));
    }
}

TEST_CASE("a bonded column of blocks and thin slabs swings as its masses and springs do, to second order in the step") {
    double error[3], step[3];
    const char* const fractions[] = {"0.6", "0.3", "0.15"};
    for (int i = 0; i < 3; ++i)
        error[i] = error_of_column(std::string("substeps: 4, step_fraction: ") + fractions[i], 0.1, step[i]);
    const double largest = std::abs(top_in_closed_form(0.1));
    CAPTURE(error[0], error[1], error[2], step[0], step[1], step[2]);
    // Leapfrog is wrong by (omega dt)^2/24 in the phase of an oscillation; the slow ones have omega of 198 to 805 1/s.
    CHECK(error[0] < 0.1 * largest);
    CHECK(error[1] < 0.35 * error[0]);
    CHECK(error[2] < 0.35 * error[1]);
}

TEST_CASE("the work of all kicks is the change of kinetic energy, with substeps too") {
    for (const char* of_run : choices_of_run) {
        WholeRun run(rubble(of_run));
        double largest = 0.0;
        run.to_the_end([&](WholeRun& r) { largest = std::max(largest, std::abs(r.simulation().ledger_error())); });
        CAPTURE(of_run);
        CHECK(largest < 1e-9 * run.state().ledger.largest);
    }
}

TEST_CASE("an undamped column with substeps keeps its energy for twenty thousand steps") {
    WholeRun run(column("{until: {time: 10}, substeps: 4}"));
    double worst = 0.0;
    run.to_the_end([&](WholeRun& r) {
        if (r.state().total_steps % 100 == 0) worst = std::max(worst, std::abs(r.simulation().energy_drift()));
    });
    const double work = 3 * 2520.0 * 10.0 * 6e-4;  // J, weight of all times what the top sinks: what swings
    CAPTURE(worst, work, run.state().total_steps, run.state().stage_step);
    CHECK(run.state().total_steps > 10000);
    CHECK(worst < 0.1 * work);
}

TEST_CASE("blocks that collide freely keep their momentum with substeps") {
    WholeRun run(scenario_of(R"(
title: Large on small
materials: {rock: {density: 2500}}
joints: {joint: {normal_stiffness: 1e8, shear_stiffness: 5e7, friction_angle_deg: 30}}
blocks:
  - {name: piece, rectangle: {corner: [0, 0], size: [0.03, 0.03]}, velocity: [0, 1], repeat: {count: 5, step: [0.13, 0.01]}}
  - {name: large, rectangle: {corner: [-0.2, 0.08], size: [1, 1]}, velocity: [0.3, -1]}
run: {until: {time: 0.3}, substeps: 8}
)"));
    const auto momentum = [&] {
        Vec2 linear = Vec2::Zero();
        double angular = 0.0;
        for (BlockId b = 0; b < run.model().blocks.size(); ++b) {
            const Vec2 p = run.model().blocks.mass[b] * run.state().motion.velocity[b];
            linear += p;
            angular +=
                cross(run.state().motion.position[b], p) + run.state().motion.spin[b] / run.model().blocks.inv_inertia[b];
        }
        return std::pair(linear, angular);
    };
    const auto [linear, angular] = momentum();
    run.to_the_end();
    REQUIRE(run.state().substeps > 1);
    CHECK(run.state().motion.velocity[0].y() < 0.5);  // they met
    CHECK((momentum().first - linear).norm() < 1e-10 * linear.norm());
    CHECK(std::abs(momentum().second - angular) < 1e-4 * 2500.0);
}

TEST_CASE("substeps that save nothing are not taken when they are left to the program") {
    WholeRun alike(scenario_of(R"(
title: Alike
gravity: [0, -10]
materials: {rock: {density: 2500}}
joints: {joint: {normal_stiffness: 1e8, shear_stiffness: 5e7, friction_angle_deg: 30}}
blocks:
  - {name: floor, held: true, rectangle: {corner: [-1, -1], size: [9, 1]}}
  - {name: block, rectangle: {corner: [0, 0], size: [1, 1]}, repeat: {count: 5, step: [0, 1]}}
run: {until: {time: 0.1}, substeps: auto}
)"));
    alike.simulation().begin_stage();
    CHECK(alike.state().substeps == 1);
    CHECK(alike.state().fast.empty());
}

TEST_CASE("a step above what slow blocks allow ends in a report, not in energy from nowhere") {
    Scenario scenario = column("{until: {time: 1}, substeps: 8, unchecked: true}");
    scenario.run.step_fraction = 4.0;
    WholeRun run(scenario);
    CHECK_THROWS_AS(run.to_the_end(), DivergenceError);
}

TEST_CASE("a step that is given may be longer than the limit only where substeps are taken") {
    // Steps go as the square root of the size: the chip is stable below 8e-5 s, the block below ten times that.
    const std::string scene = R"(
gravity: [0, -9.81]
materials: {rock: {density: 2500}}
joints: {plane: {normal_stiffness: 1e10, shear_stiffness: 5e9, friction_angle_deg: 40}}
blocks:
  - {name: plane, rectangle: {corner: [-2, -1], size: [4, 1]}, held: true}
  - {name: block, rectangle: {corner: [-0.5, 0], size: [1, 1]}}
  - {name: chip, rectangle: {corner: [0.6, 0], size: [0.01, 0.01]}}
)";
    const auto begin = [&](const std::string& run) {
        const Scenario scenario = scenario_of(scene + "run: {" + run + "}\n");
        Simulation simulation(scenario, build(scenario));
        simulation.begin_stage();
        return simulation.state().substeps;
    };
    CHECK(begin("until: {time: 0.2}, time_step: 1.5e-4, substeps: 8") == 8);
    CHECK_THROWS_WITH(begin("until: {time: 0.2}, time_step: 1.5e-4"), Catch::Contains("is above the stable step"));
    CHECK_THROWS_WITH(begin("until: {time: 0.2, equilibrium: 1e-3}, time_step: 1.5e-4, substeps: 8"),
                      Catch::Contains("is above the stable step"));
    CHECK_THROWS_WITH(begin("until: {time: 0.2}, time_step: 2e-2, substeps: 8"),
                      Catch::Contains("is above the stable step"));
}

TEST_CASE("three substeps are refused, and substeps of a solver that has no such step") {
    const auto refused = [](const std::string& rest, const std::string& why) {
        CHECK_THROWS_WITH(rubble(rest), Catch::Contains("run.substeps") && Catch::Contains(why));
    };
    refused("substeps: 3", "power of two");
    refused("substeps: 16", "1 to 8");
    refused("substeps: 4, solver: rigid", "explicit");
}
