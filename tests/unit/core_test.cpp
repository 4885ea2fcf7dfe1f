#include "core/random.hpp"
#include "core/text.hpp"
#include "core/time_table.hpp"
#include "core/turn.hpp"
#include "support/catch.hpp"

#include <cmath>

using namespace talus;

TEST_CASE("a time table is linear between its points and constant outside them") {
    const TimeTable ramp{{1.0, 3.0}, {0.0, 4.0}};
    CHECK(ramp(0.0) == 0.0);
    CHECK(ramp(2.0) == 2.0);
    CHECK(ramp(9.0) == 4.0);
    CHECK(TimeTable{}(5.0) == 0.0);
    CHECK(TimeTable::constant(7.0)(-1.0) == 7.0);
}

TEST_CASE("the mean of a time table is its integral over the span") {
    const TimeTable table{{1.0, 3.0, 3.5, 6.0}, {0.0, 4.0, -2.0, -2.0}};
    CHECK(table.mean(2.0, 0.0) == table(2.0));
    CHECK(table.mean(2.0, 1.0) == Approx(2.0));                        // one straight line
    CHECK(table.mean(1.0, 1.0) == Approx(0.5 * 0.5 * 1.0 / 1.0));      // a triangle of 0.5 s and 1
    CHECK(table.mean(3.0, 10.0) == Approx((4.0 + 0.5 - 9.0) / 10.0));  // from -2 to 8: 2 x 4/2, 0.5 x (4-2)/2, 4.5 x -2
    CHECK(TimeTable::constant(7.0).mean(3.0, 2.0) == 7.0);
    CHECK(TimeTable{}.mean(3.0, 2.0) == 0.0);
    double sum = 0.0;  // means of spans side by side add up to the whole
    for (int i = 0; i < 70; ++i) sum += 0.1 * table.mean(0.05 + 0.1 * i, 0.1);
    CHECK(sum == Approx(7.0 * table.mean(3.5, 7.0)));
}

TEST_CASE("normal numbers have mean zero and deviation one") {
    Random random(42);
    double sum = 0.0, squares = 0.0;
    const int n = 100000;
    for (int i = 0; i < n; ++i) {
        const double x = random.normal();
        sum += x;
        squares += x * x;
    }
    CHECK(std::abs(sum / n) < 0.02);
    CHECK(squares / n == Approx(1.0).epsilon(0.02));
}

TEST_CASE("a place has the digits it takes to find a thing of its size, near the origin and on a map") {
    CHECK(place({1.23456, -0.00001}, 1.0) == "(1.23, 0.00)");
    CHECK(place({465993.93551, 6691596.80163}, 0.05) == "(465993.9355, 6691596.8016)");
    CHECK(place({465993.93551, 6691596.80163}, 300.0) == "(465994, 6691597)");
    CHECK(place({465993.93551, 6691596.80163}) == "(465993.9355, 6691596.802)");
}

TEST_CASE("sine and cosine are those of the library to the last place or two, in every quarter and far from zero") {
    Random random(5);
    double worst = 0.0;
    for (int i = 0; i < 200000; ++i) {
        const double angle = (2.0 * random.uniform() - 1.0) * std::pow(10.0, 8.0 * random.uniform() - 4.0);
        const Turn now = turn(angle);
        worst = std::max({worst, std::abs(now.s - std::sin(angle)), std::abs(now.c - std::cos(angle))});
    }
    CHECK(worst < 2.3e-16);
    CHECK(turn(0.0).c == 1.0);
    CHECK(turn(0.0).s == 0.0);
    CHECK(turn(1e-9).s == 1e-9);
}
