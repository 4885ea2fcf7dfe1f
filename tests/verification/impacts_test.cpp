// Corner against corner, corner against edge and edge against edge, as chance has it. A contact force that jumps where the
// nearest corner or edge changes makes or loses energy at every step length; that of a potential does not.
#include "core/random.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "support/whole_run.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

using namespace talus;
using namespace talus::test;

namespace {

constexpr double stiffness = 1e8;                                // Pa/m
constexpr double mass = 2500.0;                                  // kg, of a square of 1 m
const double omega = std::sqrt(stiffness * 1.0 / (0.5 * mass));  // 1/s, face on face, reduced mass

BlockSpec square(const Vec2& centre, double angle) {
    Polygon corners;
    for (int k = 0; k < 4; ++k) {
        const double at = angle + std::numbers::pi * (0.25 + 0.5 * k);
        corners.push_back(centre + std::sqrt(0.5) * Vec2(std::cos(at), std::sin(at)));
    }
    return scenes::block("", corners);
}

/// Changes of the energy in 300 impacts at 1 m/s, as shares of it, ascending. step: in units of 1/omega.
std::vector<double> changes(double step, bool face_path) {
    Random random(17);
    std::vector<double> all;
    while (all.size() < 300) {
        auto a = square({0.0, 0.0}, 2.0 * random.uniform()),
             b = square({1.5, 1.2 * random.uniform() - 0.6}, 2.0 * random.uniform());
        a.velocity = {1.0, 0.0};
        Scenario scene = scenes::with({a, b});
        scene.gravity = {};
        scene.joints[0].normal_stiffness = stiffness, scene.joints[0].shear_stiffness = stiffness;
        scene.joints[0].friction_angle = 0.0;
        scene.run.time_step = step / omega;
        scene.run.until.time = 1.2;
        scene.run.face_path = face_path;
        WholeRun run(scene);
        run.to_the_end();
        if (run.state().motion.velocity[1].norm() == 0.0) continue;               // it has missed
        all.push_back(std::abs(run.simulation().energy_drift()) / (0.5 * mass));  // some still touch
    }
    std::sort(all.begin(), all.end());
    return all;
}

}  // namespace

TEST_CASE("squares that hit each other anyhow keep their energy, the more exactly the shorter the step") {
    const std::vector<double> coarse = changes(0.2, false), fine = changes(0.1, false);
    CAPTURE(coarse[150], coarse.back(), fine[150], fine.back());
    CHECK(fine[150] < 1e-6);
    CHECK(fine.back() < 2e-3);
    CHECK(coarse[150] > 4.0 * fine[150]);  // third order would be 8
}
