// One hash: the state after any number of steps depends on the scenario alone, neither on the search, the skin, the threads,
// nor on Scratch that was lost or a restart on the way.
#include "contact/search.hpp"
#include "core/random.hpp"
#include "model/hash.hpp"
#include "output/restart.hpp"
#include "simulation/trial.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/whole_run.hpp"

#include <algorithm>
#include <set>
#include <vector>

using namespace talus;
using namespace talus::test;

namespace {

// A slope of some 600 blocks (more than two chunks of the parallel loops) under in-situ stress, one joint set bonded: it
// settles, its toe is dug away over a twentieth of a second, then gravity grows and it comes down.
const std::string slope = R"(
title: Slope that loses its toe
gravity: {time: [0, 0.1], x: [0, 0], y: [-9.81, -40]}
materials: {rock: {density: 2500}}
joints:
  bedding: {normal_stiffness: 1e8, shear_stiffness: 5e7, friction_angle_deg: 15, dilation_angle_deg: 5, dilation_cutoff_slip: 0.01}
  cross: {normal_stiffness: 1e8, shear_stiffness: 5e7, friction_angle_deg: 40, cohesion: 2e4, tension: 5e3,
          residual: {friction_angle_deg: 30}}
contacts: {default: bedding}
rock:
  outline: [[0, 0], [40, 0], [40, 10], [28, 10], [18, 30], [0, 30]]
  joint_sets:
    - {angle_deg: -38, spacing: 1.1, joint: bedding}
    - {angle_deg: 55, spacing: {mean: 1.4, deviation: 0.2}, seed: 5, joint: cross}
  held: {left: true, right: true, bottom: true}
initial_stress: {k0: 0.5}
stages:
  - {name: settle, damping: {local: 0.8}, until: {time: 0.1}, reset: true}
  - {name: dig, delete: [{inside: [[22, 8], [34, 8], [34, 12], [22, 12]]}], release: 0.05, until: {time: 0.1}}
run: {until: {time: 0.3}, damping: {contact: 1e-5}}
)";

// Rock that stands, and five stones thrown at it: few blocks leave their boxes, often, and meet blocks that keep theirs.
const std::string stones = R"(
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
  - {name: stone, outline: [[2, 10], [2.6, 10.1], [2.4, 10.6]], repeat: {count: 5, step: [2.3, 0.4]}, velocity: [3, -9]}
initial_stress: {k0: 0.5}
run: {until: {time: 0.4}, damping: {contact: 1e-5}}
)";

constexpr int look = 50;  // steps between two hashes

struct Trace {
    std::vector<std::uint64_t> hashes;
    std::int64_t steps = 0, refreshes = 0;
};

template <class AfterStep>
Trace trace(WholeRun run, AfterStep after_step) {
    Trace found;
    run.to_the_end([&](WholeRun& r) {
        if (r.state().total_steps % look == 0) found.hashes.push_back(state_hash(r.model(), r.state()));
        after_step(r);
    });
    found.hashes.push_back(state_hash(run.model(), run.state()));
    found.steps = run.state().total_steps;
    found.refreshes = run.simulation().refreshes();
    return found;
}

Trace trace(const Scenario& scenario) {
    return trace(WholeRun(scenario), [](WholeRun&) {});
}

const Trace& reference() {
    static const Trace found = trace(scenario_of(slope));
    return found;
}

}  // namespace

TEST_CASE("the slope of the hash tests breaks, slides, comes apart and refreshes its pairs") {
    WholeRun run(scenario_of(slope));
    int sliding = 0, dilated = 0;
    std::int64_t steps_of_stage[3] = {0, 0, 0};
    run.to_the_end([&](WholeRun& r) { ++steps_of_stage[r.state().stage]; });
    const State& end = run.state();
    for (const Contact& c : end.contacts.list) sliding += c.sliding, dilated += c.dilation > 0.0;
    double farthest = 0.0;
    int removed = 0;
    for (BlockId b = 0; b < run.model().blocks.size(); ++b) {
        removed += end.removed[b];
        if (!end.removed[b]) farthest = std::max(farthest, (end.motion.position[b] - end.start_position[b]).norm());
    }
    CAPTURE(run.model().blocks.size(), end.total_steps, farthest, sliding, dilated, removed, run.simulation().refreshes());
    CHECK(run.model().blocks.size() > 512);
    CHECK(removed > 5);
    CHECK(farthest > 1.0);
    CHECK(sliding > 20);
    CHECK(dilated > 20);
    CHECK(std::set<std::uint8_t>(end.contacts.broken.begin(), end.contacts.broken.end()).size() == 3);  // intact, 1 and 2
    CHECK(run.simulation().refreshes() > 10);
    for (const std::int64_t steps : steps_of_stage) CHECK(steps > 100);
}

namespace {
struct Choice {
    int threads;
    double skin;  // m; < 0: automatic
};
}  // namespace

TEST_CASE("one hash for every search, number of threads and skin") {
    for (const char* search : {"auto", "dess", "isu-parallel"})
        for (const auto& [threads, skin] : {Choice{1, -1.0}, Choice{2, -1.0}, Choice{1, 0.0}, Choice{2, 0.4}}) {
            Scenario scenario = scenario_of(slope);
            scenario.run.search = search;
            scenario.run.threads = threads;
            if (skin >= 0.0) scenario.run.skin = skin;
            CAPTURE(search, threads, skin);
            const Trace found = trace(scenario);
            CHECK(found.hashes == reference().hashes);
            if (skin == 0.0) CHECK(found.refreshes > found.steps / 2);
            if (skin > 0.0) CHECK(found.refreshes < reference().refreshes);
        }
}

TEST_CASE("one hash for any axes along which boxes are taken") {
    for (const double angle : {0.0, 0.5}) {  // rad
        const Scenario scenario = scenario_of(slope);
        Scene scene = build(scenario);
        scene.model.box_axis = {std::cos(angle), std::sin(angle)};
        CAPTURE(angle);
        CHECK(trace(WholeRun(scenario, std::move(scene)), [](WholeRun&) {}).hashes == reference().hashes);
    }
}

TEST_CASE("one hash where few blocks are fast and the rest stays, and only those are looked at again") {
    const Trace expected = trace(scenario_of(stones));
    for (const char* search : search_names())
        for (const auto& [threads, skin] : {Choice{1, -1.0}, Choice{1, 0.2}, Choice{1, 0.0}, Choice{2, 0.01}}) {
            if ((skin == 0.0 || threads > 1) && search != search_names().front()) continue;  // these take their time
            Scenario scenario = scenario_of(stones);
            scenario.run.search = search;
            scenario.run.threads = threads;
            if (skin >= 0.0) scenario.run.skin = skin;
            CAPTURE(search, threads, skin);
            WholeRun run(scenario);
            Trace found;
            run.to_the_end([&](WholeRun& r) {
                if (r.state().total_steps % look == 0) found.hashes.push_back(state_hash(r.model(), r.state()));
            });
            found.hashes.push_back(state_hash(run.model(), run.state()));
            CHECK(found.hashes == expected.hashes);
            const std::int64_t all = run.simulation().refreshes() * run.model().blocks.size();
            CHECK(run.simulation().refreshes() > 5);
            if (skin != 0.0) CHECK(run.simulation().boxes_renewed() < all / 4);
        }
}

TEST_CASE("scratch may be thrown away at any step") {
    Random random(11);
    int dropped = 0;
    const Trace found = trace(WholeRun(scenario_of(slope)), [&](WholeRun& r) {
        if (random.bits() % 20 != 0) return;
        r.simulation().drop_scratch();
        ++dropped;
    });
    CHECK(dropped > 10);
    CHECK(found.hashes == reference().hashes);
}

TEST_CASE("a run saved in the middle of its stages and read back goes on as if it had not stopped") {
    const Folder folder;
    const std::string path = folder / "slope.restart.h5";
    Random random(7);
    std::set<int> stages;
    int restarts = 0;
    const Trace found = trace(WholeRun(scenario_of(slope)), [&](WholeRun& r) {
        if (random.bits() % 60 != 0) return;
        write_restart(path, RestartInfo{}, r.state());
        State saved = read_restart(path, r.model());
        r.go_on_from(std::move(saved));
        stages.insert(r.state().stage);
        ++restarts;
    });
    CHECK(restarts > 5);
    CHECK(stages.size() == 3);
    CHECK(found.hashes == reference().hashes);
}

namespace {

// A rock mass that takes up its weight, then an opening is cut out: bonds break, slip makes joints weaker, and pairs change.
const std::string opening = R"(
title: Rock mass that takes up its weight, and an opening
gravity: [0, -9.81]
materials: {rock: {density: 2500}}
joints:
  bedding: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 35}
  cross: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 40, cohesion: 2e4, tension: 5e3, residual: {friction_angle_deg: 30}}
contacts: {default: bedding}
rock:
  outline: [[0, 0], [24, 0], [24, 20], [0, 20]]
  joint_sets:
    - {angle_deg: 8, spacing: 0.9, joint: bedding}
    - {angle_deg: 95, spacing: {mean: 1.0, deviation: 0.2}, seed: 5, joint: cross}
  held: {bottom: true, left: roller, right: roller}
  slivers: {area: 0.1, width: 0.1}
stages:
  - {name: settle, settle: true}
  - {name: dig, delete: [{inside: [[10, 6], [14, 6], [14, 9], [10, 9]]}], until: {equilibrium: 1e-6}}
run: {solver: static, until: {equilibrium: 1e-6}}
)";

}  // namespace

TEST_CASE(
    "static: stones that roll down a slope and hit each other have no equilibrium, and it is known before they are far") {
    const Scenario scenario = scenario_of(R"(
gravity: [0, -9.81]
materials: {rock: {density: 2600}}
joints: {joint: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 20}}
blocks:
  - {name: slope, outline: [[0, 0], [60, 0], [0, 34]], held: true}
  - {name: step, rectangle: {corner: [10, 28.4], size: [0.5, 0.4], angle_deg: -29.54}, held: true}
  - {name: stone, rectangle: {corner: [1, 34], size: [0.9, 1.1], angle_deg: 5}, repeat: {count: 8, step: [1.6, -0.35]}}
run: {solver: static, until: {equilibrium: 1e-6}}
)");
    WholeRun run(scenario);
    run.to_the_end();
    const StaticEvidence& evidence = run.state().statics.now;
    CHECK(evidence.reached == 0);
    REQUIRE(evidence.moving >= 2);
    CHECK((run.state().motion.position[evidence.moving] - run.model().blocks.start[evidence.moving]).norm() < 30.0);
}

TEST_CASE("one hash for a static run with any number of threads, any skin, stopped and resumed, scratch thrown away") {
    const Scenario scenario = scenario_of(opening);
    std::int64_t newton = 0;
    int broken = 0, stages = 0;
    const Trace expected = trace(WholeRun(scenario), [&](WholeRun& r) {
        const Statics& s = r.state().statics;
        newton = static_cast<std::int64_t>(s.newton_ratios.size());
        stages = static_cast<int>(s.earlier.size()) + s.now.reached;
        const std::vector<std::uint8_t>& cells = r.state().contacts.broken;
        broken = static_cast<int>(std::ranges::count_if(cells, [](std::uint8_t cell) { return cell != 0; }));
    });
    CHECK(newton > 3);
    CHECK(broken > 10);
    CHECK(stages == 3);
    CHECK(expected.refreshes > 3);
    CHECK(expected.hashes.size() > 10);

    Scenario other = scenario;
    other.run.threads = 2;
    other.run.skin = 0.01;
    CHECK(trace(other).hashes == expected.hashes);

    const Folder folder;
    const std::string path = folder / "static.restart.h5";
    Random random(3);
    int restarts = 0;
    const Trace resumed = trace(WholeRun(scenario), [&](WholeRun& r) {
        const auto dice = random.bits() % 120;
        if (dice == 0) {
            write_restart(path, RestartInfo{}, r.state());
            r.go_on_from(read_restart(path, r.model()));
            ++restarts;
        } else if (dice < 3) {
            r.simulation().drop_scratch();
        }
    });
    CHECK(restarts > 3);
    CHECK(resumed.hashes == expected.hashes);
}

TEST_CASE("a run that is resumed has not forgotten that a stage before found no equilibrium") {
    WholeRun run(scenario_of(R"(
gravity: [0, -9.81]
materials: {rock: {density: 2500}}
joints: {plane: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 20}}
blocks:
  - {name: plane, outline: [[0, 0], [40, 0], [40, 40]], held: true}
  - {name: block, outline: [[35, 35], [36, 36], [35.5, 36.5], [34.5, 35.5]]}
stages: [{name: stand, solver: static, reset: true, until: {equilibrium: 1e-6}}]
run: {solver: explicit, until: {time: 0.01}}
)"));
    const Folder folder;
    const std::string path = folder / "slides.restart.h5";
    bool resumed = false;
    run.to_the_end([&](WholeRun& r) {  // 45 degrees are steeper than 20
        if (resumed || r.state().stage == 0) return;
        write_restart(path, RestartInfo{}, r.state());
        r.go_on_from(read_restart(path, r.model()));
        resumed = true;
    });
    REQUIRE(resumed);
    REQUIRE(run.state().unsettled.size() == 1);
    CHECK(run.state().unsettled[0].stage == 0);
    CHECK(run.state().unsettled[0].ratio > 1e-6);
    CHECK(out_of_time(run.simulation(), run.state().unsettled[0]).find("stage stand has no equilibrium: block 1 `block`") ==
          0);
}
