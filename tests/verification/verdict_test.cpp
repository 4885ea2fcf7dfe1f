// The mode of a single block on a plane, from Newton's laws at the instant of release, near every boundary of the chart.
#include "scenario/reader.hpp"
#include "simulation/run.hpp"
#include "support/catch.hpp"

#include <cmath>
#include <sstream>
#include <vector>

using namespace talus;

namespace {

struct Point {
    double slope, friction, slenderness;  // deg, deg, base over height
};

/// tan(friction) from which the toe of a block that topples does not slip [Voegele 1979, Bray & Goodman 1981, Sagaseta
/// 1986]: F(a, t) = ((1 + 4 t^2) sin a + 3 t cos a) / ((4 + t^2) cos a + 3 t sin a).
double least_friction(double slope, double t) {
    const double s = std::sin(radians(slope)), c = std::cos(radians(slope));
    return ((1.0 + 4.0 * t * t) * s + 3.0 * t * c) / ((4.0 + t * t) * c + 3.0 * t * s);
}

Mechanism by_theory(const Point& p) {
    const double delta = degrees(std::atan(p.slenderness));
    if (p.slope <= p.friction && p.slope <= delta) return Mechanism::none;
    if (p.slope > p.friction && p.friction < delta) return Mechanism::slide;
    if (p.slope > delta && std::tan(radians(p.friction)) >= least_friction(p.slope, p.slenderness)) return Mechanism::topple;
    return Mechanism::slide_and_topple;
}

/// Both sides of the four boundaries, at `off` degrees from them.
std::vector<Point> near_boundaries(double off) {
    std::vector<Point> all;
    for (const double t : {0.2, 0.4, 0.6}) {
        const double delta = degrees(std::atan(t));
        for (const double side : {-off, off}) {
            for (const double share : {0.3, 0.9}) all.push_back({share * delta, share * delta + side, t});
            for (const double more : {5.0, 25.0}) all.push_back({delta + side, delta + more, t});
            for (const double more : {3.0, 8.0, 20.0, 40.0}) {
                if (more < 40.0) all.push_back({delta + more, delta + side, t});  // steeper ones hardly turn there
                all.push_back({delta + more, degrees(std::atan(least_friction(delta + more, t))) + side, t});
            }
        }
    }
    return all;
}

/// Drawn flat with gravity turned.
StabilityVerdict verdict_on(const Point& p, const std::string& solver) {
    std::ostringstream text;
    text.precision(17);
    const double x = 9.81 * std::sin(radians(p.slope)), y = -9.81 * std::cos(radians(p.slope));
    text << "title: block on a plane\ngravity: [" << x << ", " << y << "]\nmaterials: {rock: {density: 2500}}\n"
         << "joints: {plane: {normal_stiffness: 3e11, shear_stiffness: 1.5e11, friction_angle_deg: " << p.friction << "}}\n"
         << "blocks:\n  - {name: plane, rectangle: {corner: [-20, -1], size: [400, 1]}, held: true}\n"
         << "  - {name: block, rectangle: {corner: [0, 0], size: [" << p.slenderness << ", 1]}}\n"
         << "run: {until: {verdict: true, time: 10}, solver: " << solver << "}\n";
    const Scenario scenario = read_scenario_text(text.str(), "test.yaml", ".");
    Simulation simulation(scenario, build(scenario));
    run(simulation, {});
    return simulation.verdict();
}

}  // namespace

TEST_CASE("a block slides, topples or does both as Newton's laws say, 0.3 degrees to both sides of every boundary") {
    const std::vector<Point> points = near_boundaries(0.3);
    REQUIRE(points.size() == 66);
    for (const Point& p : points) {
        const StabilityVerdict found = verdict_on(p, "rigid");
        CAPTURE(p.slope, p.friction, p.slenderness, name_of(by_theory(p)), name_of(found.mechanism), found.reason);
        CHECK(found.verdict == (by_theory(p) == Mechanism::none ? Stability::stable : Stability::unstable));
        CHECK(found.mechanism == by_theory(p));
        CHECK(found.time < 9.0);  // it was certain before the end
    }
}

TEST_CASE("a twentieth of a degree tells a block that stands from one that slides or topples") {
    for (const Point& p : near_boundaries(0.05)) {
        const bool stands = by_theory(p) == Mechanism::none;
        const StabilityVerdict found = verdict_on(p, "rigid");
        CAPTURE(p.slope, p.friction, p.slenderness, found.reason);
        CHECK(found.verdict == (stands ? Stability::stable : Stability::unstable));
    }
}
