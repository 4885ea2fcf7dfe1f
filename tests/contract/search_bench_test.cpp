// What times the searches also judges them: the judge must be right, and a wrong search must be found out.
#include "simulation/search_bench.hpp"

#include "contact/search.hpp"
#include "core/errors.hpp"
#include "core/random.hpp"
#include "scenario/reader.hpp"
#include "simulation/record_boxes.hpp"
#include "support/catch.hpp"

#include <cmath>

using namespace talus;

namespace {

const auto nobody = [](const std::string&) {};

/// Boxes of very different sizes, many with coordinates in common, some absent.
std::vector<Box> scattered(Random& random, int count) {
    std::vector<Box> boxes;
    for (int i = 0; i < count; ++i) {
        const double x = std::floor(40.0 * random.uniform()), y = std::floor(40.0 * random.uniform());
        const double half = i % 50 == 0 ? 20.0 : std::floor(3.0 * random.uniform());
        boxes.push_back(i % 17 == 3 ? absent_box : Box{x - half, y - half, x + half, y + half});
    }
    return boxes;
}

/// Squares in a row that part and meet: half of them go to and fro by `reach`.
Trajectory to_and_fro(int steps, double reach) {
    Trajectory t{40, 0.1, {}};
    for (int f = 0; f < steps; ++f)
        for (int i = 0; i < 40; ++i) {
            const double x = i + (i % 2 == 0 ? reach * std::sin(0.7 * f) : 0.0);
            t.all.push_back({x, 0.0, x + 1.0, 1.0});
        }
    return t;
}

}  // namespace

TEST_CASE("the sweep that judges searches finds what a comparison of each box with each other finds") {
    Random random(1);
    for (int k = 0; k < 20; ++k) {
        const std::vector<Box> boxes = scattered(random, 300);
        std::vector<Pair> expected;
        for (int a = 0; a < 300; ++a)
            for (int b = a + 1; b < 300; ++b)
                if (present(boxes[a]) && present(boxes[b]) && boxes[a].overlaps(boxes[b])) expected.push_back({a, b});
        REQUIRE(expected.size() > 300);
        CHECK(pairs_by_sweep(boxes) == expected);
    }
}

TEST_CASE("every search is right at every step of a replay, with and without a skin, for one and two threads") {
    const SearchBench bench{bench_methods(), {1, 2}, {0.0, 0.05, 2.0}, 1, Check::direct};
    const std::vector<SearchCost> costs = time_searches(to_and_fro(30, 0.2), bench, nobody);
    REQUIRE(costs.size() == 6 * bench.methods.size());
    for (const SearchCost& cost : costs) {
        INFO(cost.method << ", " << cost.threads << " threads, skin " << cost.skin);
        CHECK(cost.wrong_steps.has_value() == (cost.method != "read"));
        CHECK(cost.wrong_steps.value_or(0) == 0);
        CHECK((cost.q1 <= cost.median && cost.median <= cost.q3 && cost.q3 <= cost.max && cost.mean <= cost.max));
        CHECK(cost.q1 > 0.0);
    }
}

TEST_CASE("a replay counts the pairs of each step") {
    // 39 neighbours; at sin = 0 all touch. Else of 40 squares the 20 that moved overlap one neighbour and leave the other:
    // to the right 20 pairs, to the left 19.
    Trajectory t{40, 0.1, {}};
    for (const double shift : {0.0, 0.25, -0.25, 0.0})
        for (int i = 0; i < 40; ++i) {
            const double x = i + (i % 2 == 0 ? shift : 0.0);
            t.all.push_back({x, 0.0, x + 1.0, 1.0});
        }
    const auto costs = time_searches(t, {{"isu"}, {1}, {0.0, 0.125}, 1, Check::direct}, nobody);
    CHECK(costs[0].pairs == Approx((39 + 20 + 19 + 39) / (4 * 40.0)));
    // With a skin the list is made at each of these steps, of boxes 0.25 wider: all neighbours are within reach.
    CHECK(costs[1].pairs == Approx(39 / 40.0));
}

TEST_CASE("with a large skin the pairs are listed once") {
    const auto costs = time_searches(to_and_fro(50, 0.2), {{"isu"}, {1}, {0.0, 1.0}, 1, Check::direct}, nobody);
    CHECK(costs[0].pairs < 1.0);
    CHECK(costs[1].pairs == Approx((39 + 38 + 37) / 40.0));  // up to 3 apart, less 0: the row stood still at step 0
}

TEST_CASE("what cannot be timed is refused before anything runs") {
    const Trajectory t = to_and_fro(3, 0.1);
    CHECK_THROWS_WITH(time_searches(t, {{"isu", "fastest"}}, nobody), Catch::Contains("\"fastest\""));
    CHECK_THROWS_AS(time_searches(t, {{"isu"}, {0}}, nobody), InputError);
    CHECK_THROWS_AS(time_searches(t, {{"isu"}, {1}, {-0.1}}, nobody), InputError);
    CHECK_THROWS_AS(time_searches(t, {{"isu"}, {1}, {std::nan("")}}, nobody), InputError);
    CHECK_THROWS_AS(time_searches(t, {{"isu"}, {1}, {0.0}, 0}, nobody), InputError);
    CHECK_THROWS_AS(time_searches(to_and_fro(1, 0.1), {{"isu"}}, nobody), InputError);
}

TEST_CASE("recorded boxes are those of the blocks as they fall") {
    const char* const text = R"(
title: Falling square
gravity: [0, -10]
materials: {rock: {density: 2000}}
joints: {joint: {normal_stiffness: 1e8, shear_stiffness: 1e8, friction_angle_deg: 30}}
blocks:
  - {name: floor, held: true, rectangle: {corner: [-5, -20], size: [10, 1]}}
  - {name: square, rectangle: {corner: [0, 0], size: [2, 1]}}
stages: [{name: first, until: {time: 0.5}}]
run: {until: {time: 0.5}, time_step: 1e-2, unchecked: true}
)";
    const Scenario scenario = read_scenario_text(text, "fall.yaml", ".", {"stages[0].time_step=0.01"});
    const auto fall = [](double t) { return -5.0 * t * t; };
    const auto lowest = [](const Trajectory& t, std::size_t f) { return t.step(f)[1].ymin; };

    const Trajectory all = record_boxes(scenario, {1000, 1, "0", 0.0}, nobody);
    REQUIRE(all.boxes == 2);
    REQUIRE(all.steps() == 101);  // the end of the first stage is not recorded twice
    CHECK(all.dt == Approx(0.01));
    for (std::size_t f = 0; f <= 100; ++f) CHECK(lowest(all, f) == Approx(fall(0.01 * f)).margin(1e-9));
    CHECK(all.step(100)[1].xmin == 0.0);
    CHECK(all.step(100)[1].xmax == 2.0);
    CHECK(all.step(100)[0].ymax == -19.0);

    const Trajectory part = record_boxes(scenario, {5, 10, "0.2", 0.0}, nobody);
    REQUIRE(part.steps() == 5);
    CHECK(part.dt == Approx(0.1));
    for (std::size_t f = 0; f < 5; ++f) CHECK(lowest(part, f) == Approx(fall(0.2 + 0.1 * f)).margin(1e-9));

    for (const char* last : {"run", ""})
        CHECK(lowest(record_boxes(scenario, {1, 1, last, 0.0}, nobody), 0) == Approx(fall(0.5)).margin(1e-9));

    const Trajectory turned = record_boxes(scenario, {1, 1, "0", 30.0}, nobody);
    const Box box = turned.step(0)[1];
    CHECK(box.xmax - box.xmin == Approx(std::sqrt(3.0) + 0.5));
    CHECK(box.ymax - box.ymin == Approx(1.0 + 0.5 * std::sqrt(3.0)));
    CHECK_THROWS_WITH(record_boxes(scenario, {1, 1, "3"}, nobody), Catch::Contains("the run ends at t = 1 s, before 3"));
    CHECK_THROWS_WITH(record_boxes(scenario, {1, 1, "settle"}, nobody), Catch::Contains("there are: first, run"));
    CHECK_THROWS_WITH(record_boxes(scenario, {2'000'000'000, 1, ""}, nobody), Catch::Contains("too much for memory"));
}
