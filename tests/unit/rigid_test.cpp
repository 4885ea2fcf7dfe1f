// The rigid solver piece by piece: where parts touch, impulses, what bonds carry.
#include "core/random.hpp"
#include "dynamics/motion.hpp"
#include "model/select.hpp"
#include "rigid/impulses.hpp"
#include "rigid/manifold.hpp"
#include "support/catch.hpp"
#include "support/hand_made.hpp"
#include "support/scenes.hpp"
#include "support/whole_run.hpp"

#include <cmath>
#include <numbers>

using namespace talus;
using namespace talus::rigid;
using namespace talus::test;

namespace {

/// Two blocks at rest where they are drawn.
struct TwoAtRest {
    Model model;
    Motion motion;
    Placed placed;

    TwoAtRest(const Polygon& first, const Polygon& second) : model(blocks_of_parts({{first}, {second}})) {
        motion.position = model.blocks.start;
        motion.angle = {0.0, 0.0};
        motion.velocity.assign(2, Vec2::Zero());
        motion.spin = {0.0, 0.0};
        place(model, all_awake(2), motion, 0.0, placed);
    }
    PlacedPart part(int p) const { return {model, placed, p}; }
    Vec2 apart() const { return motion.position[1] - motion.position[0]; }
};

Manifold between(const Polygon& first, const Polygon& second, double reach) {
    const TwoAtRest two(first, second);
    int hint = -1;
    Manifold m = find_manifold(two.part(0), two.part(1), two.apart(), reach, 1e-5, hint);
    for (Vec2& p : m.point) p += two.motion.position[0];
    return m;
}

/// A column of n squares of 1 kg and 1 m on the ground (body 0), after free fall over dt.
struct Column {
    std::vector<Softness> bodies;
    std::vector<Velocity> velocity;
    std::vector<Touch> touches;

    Column(int n, double fall) : bodies(n + 1, {1.0, 1.0, 6.0}), velocity(n + 1, {0.0, -fall, 0.0}) {
        bodies[0] = {};
        velocity[0] = {};
        for (int i = 0; i < n; ++i) {
            Touch c{};
            c.a = i, c.b = i + 1, c.ends = 2;
            c.ny = 1.0, c.friction = 0.5;
            c.arm_a[0] = c.arm_b[0] = 0.5, c.arm_a[1] = c.arm_b[1] = -0.5;
            c.arm_a[2] = 0.5, c.arm_b[2] = -0.5;
            prepare(c, bodies);
            touches.push_back(c);
        }
    }
};

}  // namespace

TEST_CASE("a block on a wider one touches it at both its lower corners") {
    const Manifold m = between(scenes::rectangle(0, 0, 5, 1), scenes::rectangle(1, 1.001, 2, 2), 0.01);
    REQUIRE(m.count == 2);
    CHECK(m.normal.y() == Approx(1.0));
    CHECK(m.point[0].x() == Approx(2.0));  // in the order of perp(normal)
    CHECK(m.point[1].x() == Approx(1.0));
    CHECK(m.gap[0] == Approx(0.001));
    CHECK(m.length == Approx(1.0));
}

TEST_CASE("of a tilted block only the corner that is near counts") {
    const Polygon tilted = scenes::shifted(scenes::turned(scenes::rectangle(0, 0, 1, 1), 10.0), {2.0, 1.0});
    const Manifold m = between(scenes::rectangle(0, 0, 5, 1), tilted, 0.01);
    REQUIRE(m.count == 1);
    CHECK((m.point[0] - Vec2(2.0, 1.0)).norm() < 1e-12);
    CHECK(std::abs(m.gap[0]) < 1e-12);
}

TEST_CASE("blocks that meet at a corner only, or are further apart than the reach, do not touch") {
    CHECK(between(scenes::rectangle(0, 0, 1, 1), scenes::rectangle(1, 1, 2, 2), 0.01).count == 0);
    CHECK(between(scenes::rectangle(0, 0, 1, 1), scenes::rectangle(0, 1.02, 1, 2), 0.01).count == 0);
}

TEST_CASE("impulses carry the load of a column through all its layers in about as many sweeps") {
    for (const int n : {10, 100}) {
        Column column(n, 0.04);
        ImpulseSolver solver;
        const int sweeps = solver.solve(column.touches, column.bodies, column.velocity, {1e-9, 10000}).sweeps;
        CAPTURE(n, sweeps);
        CHECK(sweeps < 20 * n);
        for (int i = 0; i < n; ++i) {
            CHECK(column.touches[i].p[0] + column.touches[i].p[1] == Approx(0.04 * (n - i)).epsilon(1e-4));
            CHECK(column.touches[i].p[0] == Approx(column.touches[i].p[1]).epsilon(1e-3));
        }
    }
}

TEST_CASE("a block pushed sideways slips once friction is used up, and sticks before") {
    for (const double push : {0.019, 0.03}) {
        Column column(1, 0.04);
        column.velocity[1].x = push;
        ImpulseSolver solver;
        solver.solve(column.touches, column.bodies, column.velocity, {1e-12, 1000});
        const Touch& c = column.touches[0];
        CHECK(c.p[0] + c.p[1] == Approx(0.04));
        CHECK(column.velocity[1].x == Approx(std::max(push - 0.02, 0.0)).margin(1e-9));
        CHECK(c.p[2] == Approx(std::min(push, 0.02)));  // along perp(normal), which is -x
        CHECK((c.p[0] - c.p[1]) == Approx(c.p[2]));     // the moment of friction about the centre: 0.5 m over 0.5 m
    }
}

TEST_CASE("bonded blocks that stand out from a wall carry what equilibrium demands, and break where it is too much") {
    for (const double tension : {1e8, 1e5}) {
        Scenario scene = scenes::with({scenes::held(scenes::block("wall", scenes::rectangle(-1, 0, 0, 1))),
                                       scenes::block("first", scenes::rectangle(0, 0, 1, 1)),
                                       scenes::block("second", scenes::rectangle(1, 0, 2, 1))});
        scene.joints = {scenes::bonded_joint("plain", 1e8, tension)};
        scene.run.solver = "rigid";
        scene.run.until.time = 0.2;
        WholeRun run(scene);
        run.to_the_end();
        const Contact& root = run.state().contacts.list[0];
        // Largest tension at the wall: 6 M / L^2 with M = 5e4 N x 1 m: 3e5 Pa; at the second joint 6 x 2.5e4 x 0.5 = 7.5e4.
        if (tension > 3e5) {
            CHECK(root.shear_force == Approx(5e4).epsilon(1e-9));
            CHECK(std::abs(root.normal_force) < 1e-3);
            CHECK(std::abs(root.moment) == Approx(5e4));
            CHECK(run.state().motion.position[2] == run.state().start_position[2]);
        } else {
            CHECK(run.state().motion.position[1].y() - run.state().start_position[1].y() == Approx(-0.2).epsilon(1e-6));
            CHECK(std::abs(run.state().motion.angle[1]) < 1e-7);
            CHECK((run.state().motion.position[2] - run.state().motion.position[1]).norm() == Approx(1.0));
        }
    }
}

TEST_CASE("what springs are needed for is refused to the rigid solver, all in one report") {
    try {
        scenario_of(R"(
gravity: [0, -9.81]
materials: {rock: {density: 2500}}
joints: {rough: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 30, dilation_angle_deg: 5}}
blocks:
  - {name: ground, rectangle: {corner: [0, 0], size: [4, 1]}, held: true}
  - {name: block, rectangle: {corner: [1, 1], size: [1, 1]}}
run: {until: {time: 1}, solver: rigid, damping: {contact: 1e-4}}
record: {history: [{quantity: energy, component: strain_normal}, {quantity: stable_step}]}
expect: [{quantity: opening, joint: [1.5, 1], below: -1e-6}]
)");
        FAIL("not refused");
    } catch (const InputError& error) {
        std::vector<std::string> keys;
        for (const Fault& fault : error.faults()) keys.push_back(fault.key);
        CHECK(keys == std::vector<std::string>{"joints.rough.dilation_angle_deg", "run.damping.contact",
                                               "record.history[0].quantity", "record.history[1].quantity",
                                               "expect[0].below"});
    }
}

TEST_CASE("restitution is for the rigid solver only: a block rebounds with its share of the speed") {
    const std::string text = R"(
gravity: [0, -10]
materials: {rock: {density: 2500}}
joints: {base: {normal_stiffness: 1e9, shear_stiffness: 5e8, restitution: 0.5}}
blocks:
  - {name: ground, rectangle: {corner: [0, 0], size: [4, 1]}, held: true}
  - {name: block, rectangle: {corner: [1, 1.2], size: [1, 1]}}
run: {until: {time: 0.3}, SOLVER}
)";
    const auto with = [&](const std::string& solver) {
        std::string full = text;
        return scenario_of(full.replace(full.find("SOLVER"), 6, solver));
    };
    CHECK_THROWS_AS(with("solver: explicit"), InputError);
    WholeRun run(with("solver: rigid, time_step: 0.001"));
    run.to_the_end();
    // Falls 0.2 m in 0.2 s, leaves with 1 m/s; 0.1 s later it stands still 0.05 m above the ground.
    CHECK(std::abs(run.state().motion.velocity[1].y()) < 0.011);
    CHECK(run.state().motion.position[1].y() == Approx(1.55).epsilon(1e-4));
}

TEST_CASE("a light block under a heavy one carries its weight, whatever the ratio of their masses") {
    for (const double ratio : {1e-2, 1e-4, 1e-6}) {
        Column column(2, 0.04);
        column.bodies[1] = {1.0 / ratio, 1.0 / ratio, 6.0 / ratio};
        for (Touch& c : column.touches) prepare(c, column.bodies);
        ImpulseSolver solver;
        const Solution found = solver.solve(column.touches, column.bodies, column.velocity, {1e-9, 200});
        CAPTURE(ratio, found.sweeps);
        CHECK(found.left <= 1e-9);
        CHECK(column.touches[0].p[0] + column.touches[0].p[1] == Approx(0.04 * (1.0 + ratio)).epsilon(1e-6));
        CHECK(column.touches[1].p[0] + column.touches[1].p[1] == Approx(0.04).epsilon(1e-6));
    }
}

TEST_CASE("what sweeps leave is told") {
    Column column(100, 0.04);
    const Solution found = ImpulseSolver().solve(column.touches, column.bodies, column.velocity, {1e-12, 5});
    CHECK(found.sweeps == 5);
    CHECK(found.left > 1e-4);
}

TEST_CASE("parts that came through a low edge are kept apart by the face they came through") {
    // A block of 1 m has come 2 cm far into a step that is 1 cm high: up would be the shorter way out.
    const Polygon step = scenes::rectangle(1, -1, 3, 0.01), block = scenes::rectangle(0.02, 0, 1.02, 1);
    CHECK(std::abs(between(step, block, 0.01).normal.y()) == Approx(1.0));
    const TwoAtRest two(step, block);
    const auto came = [&](double speed) {
        return find_manifold(two.part(0), two.part(1), two.apart(), 0.01, 1e-5, {{}, {speed, 0.0, 0.0}, 0.01});
    };
    const Manifold m = came(3.0);
    REQUIRE(m.count == 2);
    CHECK(m.normal.x() == Approx(-1.0));
    CHECK(m.gap[0] == Approx(-0.02));
    CHECK(came(1.0).count == 0);  // it has been in there before
}

TEST_CASE("rigid: nothing is fast enough to pass a wall, and nothing is lost when it is thrown back") {
    for (const double speed : {1e1, 1e3, 1e5})
        for (const double angle : {0.0, 33.0}) {
            auto shot = scenes::block(
                "shot", scenes::shifted(scenes::turned(scenes::rectangle(0, 0, 0.05, 0.05), angle), {-0.5, 0}));
            shot.velocity = {speed, 0.0};
            Scenario scene = scenes::with({scenes::held(scenes::block("wall", scenes::rectangle(0, -1, 0.1, 1))), shot});
            scene.gravity = {};
            scene.joints[0].friction_angle = 0.0;
            scene.joints[0].restitution = 1.0;
            scene.run.solver = "rigid";
            scene.run.until.time = 1.0 / speed;
            WholeRun run(scene);
            const double energy = run.simulation().energies().kinetic;
            double farthest = -1.0;
            run.to_the_end([&](WholeRun& r) { farthest = std::max(farthest, r.state().motion.position[1].x()); });
            CAPTURE(speed, angle);
            CHECK(farthest < 0.0);
            CHECK(run.state().motion.velocity[1].x() < 0.0);
            CHECK(run.simulation().energies().kinetic == Approx(energy).epsilon(1e-9));
        }
}

TEST_CASE("rigid: blocks that are pressed into each other end the run, with the place and what presses") {
    auto plate = scenes::block("plate", scenes::rectangle(-1, 1, 2, 2));
    plate.held = {true, false, true};
    plate.driven.velocity_y = TimeTable::constant(-0.5);
    Scenario scene = scenes::with({scenes::held(scenes::block("base", scenes::rectangle(-1, -1, 2, 0))),
                                   scenes::block("block", scenes::rectangle(0, 0, 1, 1)), plate});
    scene.run.solver = "rigid";
    scene.run.until.time = 10.0;
    WholeRun run(scene);
    try {
        run.to_the_end();
        FAIL("went on");
    } catch (const DivergenceError& error) {
        CHECK_THAT(error.what(),
                   Catch::Contains("of the thinner part (1 m)") && Catch::Contains("rigid blocks do not give way"));
    }
}

TEST_CASE("rigid: what is bonded to a driven block moves with it, and its bond carries weight and acceleration") {
    auto arm = scenes::block("arm", scenes::rectangle(-1, 0, 0, 1));
    arm.held = {true, false, true};
    arm.driven.velocity_y = TimeTable{{0.0, 1.0}, {0.0, 2.0}};
    Scenario scene = scenes::with({arm, scenes::block("load", scenes::rectangle(0, 0, 1, 1))});
    scene.joints = {scenes::bonded_joint("plain", 1e8, 1e8)};
    scene.run.solver = "rigid";
    scene.run.until.time = 0.5;
    WholeRun run(scene);
    run.to_the_end();
    for (const int b : {0, 1}) {
        CHECK((run.state().motion.position[b] - run.state().start_position[b]).y() == Approx(0.25));
        CHECK(run.state().motion.velocity[b].y() == Approx(1.0));
    }
    CHECK(std::abs(run.state().contacts.list[0].shear_force) == Approx(2500.0 * 12.0).epsilon(1e-6));
    // 2500 kg rise by 0.25 m and move at 1 m/s: the work of what drives it.
    CHECK(run.state().ledger.driven == Approx(2500.0 * (0.25 * 10.0 + 0.5)).epsilon(1e-6));

    scene.blocks[0].held = {false, false, false};
    scene.blocks[0].driven = {};
    scene.blocks[0].driven.velocity_y = TimeTable::constant(1.0);
    CHECK_THROWS_WITH(WholeRun(scene).to_the_end(),
                      Catch::Contains("block 0 `arm`") && Catch::Contains("along some axes only"));
}

TEST_CASE("rigid: a block that rocks is of second order in the step, through its impact") {
    // 1 x 4 m from half its critical tilt: 0.094737 rad on the other side (Housner, by quadrature with large angles).
    const auto error = [](double step) {
        Scenario scene = scenario_of(R"(
gravity: [0, -9.81]
materials: {rock: {density: 2500}}
joints: {base: {normal_stiffness: 1e10, shear_stiffness: 5e9, friction_angle_deg: 60}}
blocks:
  - {name: floor, rectangle: {corner: [-4, -1], size: [9, 1]}, held: true}
  - {name: block, rectangle: {corner: [0, 0], size: [1, 4], angle_deg: 7.01812173396}}
run: {until: {time: 1.6}, solver: rigid}
)");
        scene.run.time_step = step;
        WholeRun run(scene);
        double least = 0.0;
        run.to_the_end([&](WholeRun& r) { least = std::min(least, r.state().motion.angle[1]); });
        return std::abs(least + 0.21722612468) / 0.09473679312;
    };
    CHECK(error(0.004) < 1e-3);
    CHECK(error(0.001) < 5e-5);
    CHECK(error(0.00025) < 4e-6);
}

TEST_CASE(
    "rigid: a block that rocks loses at an impact what Housner says, wherever in a step it lands, and the ledger says so") {
    Random random(5);
    for (int trial = 0; trial < 20; ++trial) {
        const double b = 0.4 + 1.1 * random.uniform(), h = b * (1.5 + 3.5 * random.uniform());
        const double slender = std::atan(b / h), tilt = slender * (0.2 + 0.6 * random.uniform());
        Scenario scene = scenario_of(R"(
gravity: [0, -9.81]
materials: {rock: {density: 2500}}
joints: {floor: {normal_stiffness: 1e10, shear_stiffness: 5e9, friction_angle_deg: 60}}
blocks:
  - {name: floor, rectangle: {corner: [-20, -1], size: [40, 1]}, held: true}
  - {name: block, rectangle: {corner: [0, 0], size: [1, 1]}}
run: {until: {time: 6}, solver: rigid}
)");
        Polygon turned;
        for (const Vec2& p : scenes::rectangle(0, 0, b, h))
            turned.emplace_back(std::cos(tilt) * p.x() - std::sin(tilt) * p.y(),
                                std::sin(tilt) * p.x() + std::cos(tilt) * p.y());
        scene.blocks[1].outline = turned;
        // Angular momentum about the corner it lands on: the spin falls by r, the height of the next swing by r squared.
        const double r = 1.0 - 1.5 * std::pow(std::sin(slender), 2);
        const auto next_swing = [&](double swing) {
            return slender - std::acos(std::cos(slender) + r * r * (std::cos(slender - swing) - std::cos(slender)));
        };
        const double first = next_swing(tilt), second = next_swing(first);
        WholeRun run(scene);
        double lowest = 0.0, highest = -1.0;  // rad; the first swing to the other side, the second back
        bool back = false;
        run.to_the_end([&](WholeRun& w) {
            const double angle = tilt + w.state().motion.angle[1], spin = w.state().motion.spin[1];
            lowest = std::min(lowest, angle);
            back |= angle < 0.0 && spin > 0.0;
            if (back && highest < 0.0 && angle > 0.0 && spin < 0.0) highest = angle;
        });
        CAPTURE(trial, b, h, tilt);
        CHECK(-lowest == Approx(first).margin(2e-3 * tilt));
        CHECK(highest == Approx(second).margin(2e-3 * tilt));
        CHECK(std::abs(run.simulation().energy_drift()) < 0.02 * run.state().ledger.largest);
    }
}

TEST_CASE("rigid: a pulse gives all of its impulse wherever in a step it ends") {
    // Newmark: a block of friction 0.2 on a base that is shaken with 5 m/s2 for 0.2137 s slips V2 / (2 g 0.2) (1 - 0.2 g /
    // 5).
    const double slip = 5.0 * 0.2137 * 5.0 * 0.2137 / (2.0 * 10.0 * 0.2) * (1.0 - 0.4);
    for (const double step : {0.004, 0.001}) {
        Scenario scene = scenes::with({scenes::held(scenes::block("base", scenes::rectangle(-2, -1, 4, 0))),
                                       scenes::block("block", scenes::rectangle(0, 0, 2, 0.5))});
        scene.joints[0].friction_angle = std::atan(0.2);
        scene.body_acceleration.x = {{0.0, 0.2137, 0.2137000001}, {-5.0, -5.0, 0.0}};
        scene.run.solver = "rigid";
        scene.run.time_step = step;
        scene.run.until.time = 0.8;
        WholeRun run(scene);
        run.to_the_end();
        const double found = run.state().start_position[1].x() - run.state().motion.position[1].x();
        CAPTURE(step);
        CHECK(found == Approx(slip).epsilon(25.0 * step * step));  // 4e-4 at 4 ms; sampled once a step it is 7e-3
    }
}

namespace {

/// Centroid height (m), angle (rad), their rates: a square of 1 m above y = 0 that flies free, without friction or losses.
struct Flight {
    double y, angle, vy, spin;

    double corner(int k, double after) const {
        return y + after * vy + std::sqrt(0.5) * std::sin(angle + after * spin + std::numbers::pi * (0.25 + 0.5 * k));
    }
    double sinks(int k) const { return vy + spin * std::sqrt(0.5) * std::cos(angle + std::numbers::pi * (0.25 + 0.5 * k)); }

    /// From landing to landing, each an impulse at a corner that turns its speed around.
    void fly(double duration) {
        constexpr double look = 1e-4;  // s: no corner dips and rises again within it
        while (duration > 0.0) {
            double step = std::min(look, duration);
            int lands = -1;
            for (int k = 0; k < 4; ++k) {
                if (corner(k, step) >= 0.0) continue;
                double above = 0.0, below = step;
                for (int i = 0; i < 60; ++i)
                    (corner(k, 0.5 * (above + below)) > 0.0 ? above : below) = 0.5 * (above + below);
                step = below, lands = k;
            }
            y += step * vy, angle += step * spin, duration -= step;
            if (lands < 0 || sinks(lands) >= 0.0) continue;
            const double arm = std::sqrt(0.5) * std::cos(angle + std::numbers::pi * (0.25 + 0.5 * lands));
            const double impulse = -2.0 * sinks(lands) / (1.0 + 6.0 * arm * arm);  // of 1 kg, with 1/6 kg m2
            vy += impulse, spin += 6.0 * arm * impulse;
        }
    }
};

}  // namespace

TEST_CASE(
    "rigid: a square that lands on one corner and then on another keeps its energy and its way, however both fall into "
    "steps") {
    for (const double height : {0.002, 0.0017})  // at 2 m/s: at the very end of a step of 1 ms, and within it
        for (const double angle_deg : {1.0, 3.0, 13.0, 87.0})
            for (const double step : {0.1, 0.05, 0.02, 0.002, 0.001, 0.0005}) {
                Scenario scene = scenario_of(R"(
materials: {rock: {density: 1000}}
joints: {floor: {normal_stiffness: 1e10, shear_stiffness: 1e10, restitution: 1}}
blocks:
  - {name: floor, rectangle: {corner: [-10, -1], size: [20, 1]}, held: true}
  - {name: square, rectangle: {corner: [0, 0], size: [1, 1], angle_deg: 0}, velocity: [0, -2]}
run: {until: {time: 0.3}, solver: rigid}
)");
                const double angle = angle_deg * std::numbers::pi / 180.0;
                Polygon turned;
                for (const Vec2& p : scene.blocks[1].outline)
                    turned.emplace_back(std::cos(angle) * p.x() - std::sin(angle) * p.y(),
                                        height + std::sin(angle) * p.x() + std::cos(angle) * p.y());
                scene.blocks[1].outline = turned;
                scene.run.time_step = step;
                WholeRun run(scene);
                const double start = run.state().motion.position[1].y();
                run.to_the_end();
                Flight exact{height + std::sqrt(0.5) * std::sin(angle + 0.25 * std::numbers::pi), angle, -2.0, 0.0};
                REQUIRE(start + run.model().origin.y() == Approx(exact.y).epsilon(1e-9));
                exact.fly(0.3);
                CAPTURE(height, angle_deg, step);
                CHECK(run.simulation().energies().kinetic == Approx(2000.0).epsilon(1e-9));
                CHECK(run.state().motion.velocity[1].y() == Approx(exact.vy).margin(1e-4 + 4.0 * step));
                CHECK(run.state().motion.spin[1] == Approx(exact.spin).margin(1e-4 + 4.0 * step));
            }
}
