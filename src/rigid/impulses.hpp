// Impulses between bodies that touch: Coulomb friction and no approach, for all contacts at once.
#pragma once

#include <span>
#include <vector>

namespace talus::rigid {

struct Velocity {
    double x = 0.0, y = 0.0, spin = 0.0;  // m/s, m/s, rad/s
};

struct Softness {
    double x = 0.0, y = 0.0, spin = 0.0;  // 1/kg, 1/kg, 1/(kg m2): inverse mass and inertia; 0 = does not give way
};

/// Two bodies at one manifold. Impulses act on b, and against a: p[0], p[1] along the normal at both ends, p[2] along
/// perp(normal), the same line for both ends.
struct Touch {
    int a, b;                             // bodies
    int ends;                             // 1 or 2
    double nx, ny;                        // unit, from a to b
    double arm_a[3];                      // m, arm x direction, of each impulse about the centroid of the body
    double arm_b[3];                      // m
    double k00, k01, k11;                 // 1/kg, velocity of approach per impulse at both ends; k00, k11 = 0: no impulse
    double kt;                            // 1/kg, the same along perp(normal), no less than `barely`
    double barely;                        // 1/kg, what is not softer does not give way: held, on rollers or driven that way
    double least[2];                      // m/s, velocity along the normal after the impulse is no less than this
    double sticks;                        // m/s, velocity along perp(normal) after the impulse, where friction is enough
    double friction;                      // 1, tangent
    double along = 1.0, against = 1.0;    // shares of friction that may act along perp(normal), and against it
    bool slips = false;                   // friction is not enough
    bool coupled = false;                 // see coupled.hpp; known while impulses are sought
    double cohesion;                      // N s, what may act along perp(normal) without any pressure
    double p[3] = {0.0, 0.0, 0.0};        // N s
    double earlier[3] = {0.0, 0.0, 0.0};  // N s, what acted before an impact ended it, whatever the velocities after it
};

/// Fills k00, k01, k11, kt and `barely` from ends, directions, arms and bodies.
void prepare(Touch& touch, std::span<const Softness> bodies);

struct Convergence {
    double tolerance;  // m/s: no impulse changes any relative velocity by more in the last sweep
    int sweeps;        // at most
};

struct Solution {
    int sweeps;
    double left;  // m/s, largest change of a relative velocity in the last sweep
};

/// Gauss-Seidel over the contacts, to and fro, each solved by itself (both normal impulses together, exactly, then
/// friction) [jean1999]; the error left by a sweep is used as the gradient of a nonlinear conjugate gradient method
/// [silcowitz2010], which carries load through n layers in about n sweeps instead of n^2. Begins with the impulses there
/// are; `velocity` must already contain them. The order is that of `touches` and never that of threads.
class ImpulseSolver {
public:
    Solution solve(std::span<Touch> touches, std::span<const Softness> bodies, std::span<Velocity> velocity,
                   Convergence until);

private:
    double help(std::span<Touch> touches, std::span<const Softness> bodies, std::span<Velocity> velocity, double left,
                double tolerance);
    void remember(std::span<const Touch> touches, std::span<const Velocity> velocity);
    void recall(std::span<Touch> touches, std::span<Velocity> velocity) const;
    void keep(std::span<const Touch> touches, std::span<const Velocity> velocity);
    void accelerate(std::span<Touch> touches, std::span<Velocity> velocity);

    double norm_ = 0.0;                                // of the last change
    std::vector<double> impulse_, impulse_direction_;  // [3 n]
    std::vector<Velocity> velocity_, velocity_direction_;
    std::vector<Touch> touches_before_;  // a direct solution was tried
    std::vector<Velocity> velocity_before_;
};

/// Adds the effect of the impulses of one contact (or of other ones along its directions) to its two bodies.
void apply(const Touch& touch, const double impulse[3], std::span<const Softness> bodies, std::span<Velocity> velocity);

}  // namespace talus::rigid
