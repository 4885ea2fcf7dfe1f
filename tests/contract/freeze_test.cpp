// Blocks at rest that are not computed: the same bits for every search, number of threads and restart, within the error that
// is promised, and awake in time.
#include "core/random.hpp"
#include "model/hash.hpp"
#include "output/restart.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/whole_run.hpp"

#include <algorithm>
#include <vector>

using namespace talus;
using namespace talus::test;

namespace {

// Rock that stands under in-situ stress and swings a little, and stones that fall on it.
const std::string bench = R"(
title: Stones on a bench
gravity: [0, -9.81]
materials: {rock: {density: 2500}}
joints: {joint: {normal_stiffness: 1e8, shear_stiffness: 5e7, friction_angle_deg: 35}}
rock:
  outline: [[0, 0], [24, 0], [24, 5], [12, 5], [12, 9], [0, 9]]
  joint_sets:
    - {angle_deg: 10, spacing: 0.9}
    - {angle_deg: 95, spacing: {mean: 1.1, deviation: 0.2}, seed: 3}
  held: {left: true, right: true, bottom: true}
blocks:
  - {name: stone, outline: [[2, 9.6], [2.6, 9.7], [2.4, 10.2]], repeat: {count: 5, step: [2.3, 0.1]}, velocity: [2, -2]}
initial_stress: {k0: 0.5}
run: {until: {time: 0.4}, damping: {contact: 4e-4}, freeze: 0.01}
)";

int frozen_blocks(const WholeRun& run) {
    int count = 0;
    for (BlockId b = 0; b < run.model().blocks.size(); ++b) count += run.state().frozen(b) && !run.model().blocks.held(b);
    return count;
}

struct Trace {
    std::vector<std::uint64_t> hashes;
    int most_frozen = 0, woken = 0;
};

template <class AfterStep>
Trace trace(const Scenario& scenario, AfterStep after_step) {
    WholeRun run(scenario);
    Trace found;
    int before = 0;
    run.to_the_end([&](WholeRun& r) {
        after_step(r);
        if (r.state().total_steps % 200 != 0) return;
        found.hashes.push_back(state_hash(r.model(), r.state()));
        const int now = frozen_blocks(r);
        found.most_frozen = std::max(found.most_frozen, now);
        found.woken += std::max(0, before - now);
        before = now;
    });
    return found;
}

const Trace& reference() {
    static const Trace found = trace(scenario_of(bench), [](WholeRun&) {});
    return found;
}

// Ten blocks of 1 m and 20 kN on each other, on a held base; the column closes by the sum of what lies above each joint.
std::string column(const std::string& rest) {
    return R"(
title: Column
gravity: [0, -10]
materials: {rock: {density: 2000}}
joints: {joint: {normal_stiffness: 1e8, shear_stiffness: 1e8, friction_angle_deg: 30}}
blocks:
  - {name: base, held: true, rectangle: {corner: [-1, -1], size: [3, 1]}}
  - {name: block, rectangle: {corner: [0, 0], size: [1, 1]}, repeat: {count: 10, step: [0, 1]}}
)" + rest;
}
constexpr double closure = 20e3 / 1e8;                      // m, of a joint under one block
constexpr double settlement = 10.0 * 11.0 / 2.0 * closure;  // m, of the top

double top_sinks(const WholeRun& run) {
    const BlockId top = 10;
    return run.state().start_position[top].y() - run.state().motion.position[top].y();
}

}  // namespace

TEST_CASE("most of a bench freezes, and stones that fall on it wake what they hit") {
    CAPTURE(reference().most_frozen, reference().woken);
    CHECK(reference().most_frozen > 50);
    CHECK(reference().woken > 20);
}

TEST_CASE("one hash with frozen blocks, for every search, number of threads and skin") {
    const struct {
        const char* search;
        int threads;
        double skin;  // m
    } choices[] = {{"auto", 2, 0.01}, {"isu", 1, 0.003}, {"dess", 1, 0.3}};
    for (const auto& [search, threads, skin] : choices) {
        Scenario scenario = scenario_of(bench);
        scenario.run.search = search;
        scenario.run.threads = threads;
        scenario.run.skin = skin;
        CAPTURE(search, threads, skin);
        CHECK(trace(scenario, [](WholeRun&) {}).hashes == reference().hashes);
    }
}

TEST_CASE("one hash with frozen blocks after restarts and with scratch thrown away") {
    const Folder folder;
    const std::string path = folder / "bench.restart.h5";
    Random random(11);
    int restarts = 0;
    const Trace found = trace(scenario_of(bench), [&](WholeRun& r) {
        const std::uint64_t choice = random.bits() % 500;
        if (choice == 1) r.simulation().drop_scratch();
        if (choice != 0) return;
        write_restart(path, RestartInfo{}, r.state());
        r.go_on_from(read_restart(path, r.model()));
        ++restarts;
    });
    CHECK(restarts > 5);
    CHECK(found.hashes == reference().hashes);
}

TEST_CASE("a column that freezes has settled to twice the share that was allowed") {
    for (const double share : {1e-2, 1e-3}) {
        Scenario scenario = scenario_of(column("run: {until: {time: 4}, damping: {local: 0.7}}"));
        scenario.run.freeze = share;
        WholeRun run(scenario);
        run.to_the_end();
        CAPTURE(share);
        CHECK(frozen_blocks(run) == 10);
        CHECK(top_sinks(run) == Approx(settlement).epsilon(2.0 * share));
        CHECK(std::abs(run.simulation().ledger_error()) < 1e-9 * run.simulation().energies().gravity);
    }
}

// The wedge of scenarios/accuracy/sliding_wedge.yaml in larger blocks, let go from equilibrium: the rock below rings.
const std::string wedge = R"(
title: Wedge
gravity: [0, -9.81]
materials: {upper: {density: 2600}, lower: {density: 2600}}
joints:
  plane: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 60}
  bond: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 45, cohesion: 1e9, tension: 1e9}
contacts: {default: bond, materials: [{a: upper, b: lower, joint: plane}]}
rock:
  material: lower
  outline: [[0, 0], [60, 0], [60, 5.2], [28, 40], [0, 40]]
  joint_sets:
    - {angle_deg: -35, spacing: 2.6, origin: [60, 4]}
    - {angle_deg: 80, spacing: 2.6, origin: [60.26, 4]}
  regions: {sliding: {material: upper, outline: [[60, 4], [60, 5.2], [28, 40], [8.586671757, 40]]}}
  held: {left: true, bottom: true}
  slivers: {area: 0.8, width: 0.4}
initial_stress: {k0: 0.5}
stages:
  - {name: settle, solver: static, reset: true, until: {equilibrium: 1e-6}}
  - {name: let go, change: {joints: {plane: {friction_angle_deg: 25}}}, until: {time: 1e-3}, damping: {contact: 4e-4}}
run: {until: {time: 0.999}, damping: {contact: 4e-4}, freeze: 0.03}
)";

TEST_CASE("rock under a wedge that slides out is frozen while it rings by less than a share of what its joints carry") {
    WholeRun run(scenario_of(wedge));
    int sliding = 0;
    run.to_the_end();
    const Model& model = run.model();
    double slide = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (model.blocks.held(b)) continue;
        const Vec2 way = run.state().motion.position[b] - run.state().start_position[b];
        if (model.material_names[model.blocks.material[b]] == "lower") {
            CHECK(way.norm() < 2e-3);
            continue;
        }
        slide += Vec2(std::cos(radians(-35)), std::sin(radians(-35))).dot(way);
        ++sliding;
    }
    const double never_moves = 1.0 - static_cast<double>(sliding) / model.blocks.size();
    CAPTURE(sliding, run.simulation().frozen_share());
    CHECK(slide / sliding == Approx(0.939796).epsilon(0.01));
    CHECK(run.simulation().frozen_share() > 0.4 * never_moves);
    CHECK(std::abs(run.simulation().ledger_error()) < 1e-9 * run.simulation().energies().gravity);
}

TEST_CASE("frozen blocks wake when gravity grows, when a load grows and when something falls on them") {
    const char* grown_gravity = R"(
run: {until: {time: 8}, damping: {local: 0.7}, freeze: 1e-3}
body_acceleration: {time: [0, 4, 4.1], x: [0, 0, 0], y: [0, 0, -5]}
)";
    const char* grown_load = R"(
run: {until: {time: 8}, damping: {local: 0.7}, freeze: 1e-3}
loads: [{block: "block[9]", force: {time: [0, 4, 4.1], x: [0, 0, 0], y: [0, 0, -100e3]}}]
)";
    const char* fallen_block = R"(
  - {name: late, rectangle: {corner: [0, 80], size: [1, 1]}}
run: {until: {time: 12}, damping: {local: 0.7}, freeze: 1e-3}
)";
    const struct {
        const char* text;
        double sinks;  // m
    } cases[] = {{grown_gravity, 1.5 * settlement},
                 {grown_load, settlement + 50.0 * closure},
                 {fallen_block, settlement + 10.0 * closure}};
    for (const auto& [text, sinks] : cases) {
        WholeRun run(scenario_of(column(text)));
        int most_before = 0;
        run.to_the_end([&](WholeRun& r) {
            if (r.state().time < 3.9) most_before = std::max(most_before, frozen_blocks(r));
        });
        CAPTURE(text);
        CHECK(most_before == 10);
        CHECK(frozen_blocks(run) >= 10);
        CHECK(top_sinks(run) == Approx(sinks).epsilon(4e-3));
    }
}
