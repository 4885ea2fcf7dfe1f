#include "simulation/expect.hpp"
#include "support/catch.hpp"

#include <cmath>
#include <functional>
#include <numbers>

using namespace talus;
using std::numbers::pi;

namespace {

Signal sampled(double step, int count, const std::function<double(double)>& f) {
    Signal s;
    for (int i = 0; i <= count; ++i) {
        s.time.push_back(i * step);
        s.value.push_back(f(i * step));
    }
    return s;
}

ExpectSpec expect(const std::string& measure) {
    ExpectSpec e;
    e.measure = measure;
    return e;
}

}  // namespace

TEST_CASE("a value between two steps is read off the straight line between them") {
    const Signal s{{0.0, 1.0, 3.0}, {0.0, 10.0, 30.0}};
    CHECK(value_at(s, 2.0) == Approx(20.0).epsilon(1e-14));
    CHECK(value_at(s, 1.0) == 10.0);
    CHECK(value_at(s, 3.0 + 1e-10) == 30.0);  // the rounding of a sum of steps
}

TEST_CASE("a time that the run did not reach has no value") {
    const Signal s{{0.0, 1.0}, {0.0, 10.0}};
    CHECK(std::isnan(value_at(s, 1.1)));
    CHECK(std::isnan(mean_rate(s, 0.0, 2.0)));
    CHECK(std::isnan(value_at({}, 0.0)));
}

TEST_CASE("an acceleration is exact because it is taken at the recorded times, not at those asked for") {
    const Signal velocity = sampled(0.03, 100, [](double t) { return 1.0 + 4.905 * t; });
    CHECK(mean_rate(velocity, 0.5, 2.0) == Approx(4.905).epsilon(1e-13));
}

TEST_CASE("a frequency is found from fractions of periods, about a mean that is not zero") {
    const Signal s = sampled(1e-4, 20000, [](double t) { return 3.0 + std::sin(2 * pi * 11.7145 * t + 0.4); });
    CHECK(frequency(s) == Approx(11.7145).epsilon(1e-6));
    CHECK(std::isnan(frequency(sampled(0.1, 10, [](double t) { return t; }))));
}

TEST_CASE("a frequency is that of the damped oscillation, whatever the level and the part of it that is seen") {
    const double w = 40.0;
    for (const double xi : {0.02, 0.11, 0.18, 0.3})
        for (const double phase : {0.0, 0.7, 2.0}) {
            const double damped = w * std::sqrt(1 - xi * xi);
            const Signal s =
                sampled(1e-4, 6000, [&](double t) { return -2.5 + std::exp(-xi * w * t) * std::cos(damped * t + phase); });
            CHECK(frequency(s) == Approx(damped / (2 * pi)).epsilon(1e-5));
        }
}

TEST_CASE("a decrement does not depend on the level about which the oscillation dies out") {
    const double xi = 0.05, w = 40.0, damped = w * std::sqrt(1 - xi * xi);
    for (const double level : {0.0, -2.5}) {
        const Signal s =
            sampled(1e-4, 10000, [&](double t) { return level + std::exp(-xi * w * t) * std::cos(damped * t); });
        CHECK(decrement(s) == Approx(0.314553).epsilon(1e-4));  // 2 pi xi / sqrt(1 - xi^2)
    }
}

TEST_CASE("the rest after a decayed oscillation does not count as cycles") {
    Signal s = sampled(1e-3, 2000, [](double t) { return std::exp(-6.0 * t) * std::cos(8 * pi * t); });
    for (std::size_t i = 0; i < s.value.size(); ++i) s.value[i] += 1e-7 * static_cast<double>(i % 3);
    CHECK(decrement(s) == Approx(1.5).epsilon(1e-3));
}

TEST_CASE("a stick-slip loop has the area 4 tau (A - tau/k)") {
    const double strength = 0.57735e6, stiffness = 5e9, amplitude = 2e-3;
    Signal shear = sampled(1e-4, 25000, [&](double t) { return 2 * amplitude / pi * std::asin(std::sin(2 * pi * t)); });
    Signal stress{shear.time, {0.0}};
    for (std::size_t i = 1; i < shear.value.size(); ++i)
        stress.value.push_back(
            std::clamp(stress.value[i - 1] + stiffness * (shear.value[i] - shear.value[i - 1]), -strength, strength));
    CHECK(loop_area(shear, stress) == Approx(4 * strength * (amplitude - strength / stiffness)).epsilon(1e-3));
    CHECK(std::isnan(loop_area(shear, Signal{})));
}

TEST_CASE("a value is met within the larger of its two tolerances") {
    const Signal s{{0.0, 1.0}, {0.0, 1.01}};
    ExpectSpec e = expect("value");
    e.value = 1.0;
    CHECK_FALSE(judge(e, "x", s).passed);
    e.tolerance = 0.005;
    CHECK_FALSE(judge(e, "x", s).passed);
    e.tolerance_absolute = 0.011;
    CHECK(judge(e, "x", s).passed);
    CHECK(judge(e, "x", s).error == Approx(0.01));
    CHECK(judge(e, "x", s).allowed == 0.011);
}

TEST_CASE("extremes are taken inside the window only") {
    const Signal s = sampled(0.1, 100, [](double t) { return t; });
    ExpectSpec e = expect("max");
    e.value = 4.0, e.between = {2.0, 4.04}, e.tolerance = 1e-12;
    CHECK(judge(e, "x", s).passed);
    e.measure = "min", e.value = 2.0;
    CHECK(judge(e, "x", s).passed);
}

TEST_CASE("a bound is crossed by the amount that the measured value lies beyond it") {
    const Signal s{{0.0, 1.0, 2.0, 3.0}, {0.0, 5.0, -7.0, 0.0}};
    ExpectSpec e = expect("min");
    e.above = -6.0;
    CHECK_FALSE(judge(e, "x", s).passed);
    CHECK(judge(e, "x", s).error == 1.0);
    e.between = {0.0, 1.5};
    CHECK(judge(e, "x", s).passed);
    e = expect("max");
    e.below = 4.5;
    CHECK(judge(e, "x", s).error == 0.5);
}

TEST_CASE("a run that ends too early passes no expectation") {
    const Signal s{{0.0, 1.0}, {0.0, 0.0}};
    ExpectSpec e = expect("value");
    e.at = 2.0, e.below = 1.0;
    CHECK_FALSE(judge(e, "x", s).passed);
    e = expect("max");
    e.between = {2.0, 3.0}, e.below = 1.0;
    CHECK_FALSE(judge(e, "x", s).passed);
    e = expect("max");
    e.value = 0.0, e.tolerance_absolute = 1.0;
    CHECK_FALSE(judge(e, "x", Signal{}).passed);
}

TEST_CASE("a bound that was never reached is told with its own side") {
    ExpectSpec above = expect("value"), below = expect("value");
    above.above = 5.0, below.below = 5.0;
    for (ExpectSpec* e : {&above, &below}) {
        e->at = 1.0;
        const Verdict verdict = judge(*e, "displacement", Signal{{0.0, 0.05}, {0.0, 0.0}});
        CHECK(std::isnan(verdict.measured));
        CHECK_FALSE(verdict.passed);
        CHECK(verdict.expected == 5.0);
        CHECK(std::string(verdict.asked) == (e == &above ? "above" : "below"));
    }
}
