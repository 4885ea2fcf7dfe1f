#include "rigid/direct.hpp"

#include <algorithm>
#include <cmath>

namespace talus::rigid {
namespace {

// 1 / W over the softness that a contact sees. Of the load of a block on one of a millionth of its mass a solution leaves a
// thousandth then; a hundredth of it, and rounding has the upper hand, a thousand times of it, and a solution leaves half.
constexpr double compliance = 1e-9;
constexpr int solutions = 10;

double give(const Softness& soft, int axis) { return axis == 0 ? soft.x : axis == 1 ? soft.y : soft.spin; }

double velocity_along(const double along[6], const Velocity& a, const Velocity& b) {
    return along[0] * a.x + along[1] * a.y + along[2] * a.spin + along[3] * b.x + along[4] * b.y + along[5] * b.spin;
}

}  // namespace

void DirectSolver::list_rows(std::span<const Touch> touches, std::span<const Softness> bodies) {
    rows_.clear();
    for (std::size_t i = 0; i < touches.size(); ++i) {
        const Touch& c = touches[i];
        const auto add = [&](int kind, double x, double y, double k, double least) {
            rows_.push_back(
                {static_cast<int>(i), kind, {-x, -y, -c.arm_a[kind], x, y, c.arm_b[kind]}, 1.0 / (compliance * k), least});
        };
        for (int end = 0; end < c.ends; ++end)
            if (c.p[end] > 0.0) add(end, c.nx, c.ny, end == 0 ? c.k00 : c.k11, c.least[end]);
        if (!c.slips && c.kt > c.barely) add(2, -c.ny, c.nx, c.kt, c.sticks);
    }
    unknown_.assign(bodies.size(), -1);
    unknowns_ = 0;
    for (const Row& row : rows_)
        for (const int q : {touches[row.touch].a, touches[row.touch].b}) {
            const Softness& soft = bodies[q];
            if (unknown_[q] < 0 && (soft.x > 0.0 || soft.y > 0.0 || soft.spin > 0.0)) unknown_[q] = 0;
        }
    for (int& first : unknown_)
        if (first == 0) first = unknowns_, unknowns_ += 3;
}

bool DirectSolver::factor(std::span<const Touch> touches, std::span<const Softness> bodies) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(21 * rows_.size() + unknowns_);
    for (std::size_t q = 0; q < bodies.size(); ++q)
        for (int i = 0; i < 3 && unknown_[q] >= 0; ++i) {
            const double soft = give(bodies[q], i);
            entries.emplace_back(unknown_[q] + i, unknown_[q] + i, soft > 0.0 ? 1.0 / soft : 1.0);
        }
    for (const Row& row : rows_) {
        const int body[2] = {touches[row.touch].a, touches[row.touch].b};
        const auto place = [&](int i) {
            const int q = body[i / 3];
            return unknown_[q] < 0 || give(bodies[q], i % 3) == 0.0 ? -1 : unknown_[q] + i % 3;
        };
        for (int i = 0; i < 6; ++i)
            for (int j = 0; j < 6; ++j)
                if (place(j) >= 0 && place(i) >= place(j))
                    entries.emplace_back(place(i), place(j), row.weight * row.along[i] * row.along[j]);
    }
    Eigen::SparseMatrix<double> matrix(unknowns_, unknowns_);
    matrix.setFromTriplets(entries.begin(), entries.end());
    matrix_.compute(matrix);
    return matrix_.info() == Eigen::Success;
}

double DirectSolver::missing(std::span<const Touch> touches, std::span<const Velocity> velocity) {
    double most = 0.0;
    missing_.resize(rows_.size());
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        const Row& row = rows_[r];
        const Touch& c = touches[row.touch];
        missing_[r] = row.least - velocity_along(row.along, velocity[c.a], velocity[c.b]);
        most = std::max(most, std::abs(missing_[r]));
    }
    return most;
}

void DirectSolver::push(std::span<Touch> touches, std::span<const Softness> bodies, std::span<Velocity> velocity) {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(unknowns_);
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        const Row& row = rows_[r];
        const int body[2] = {touches[row.touch].a, touches[row.touch].b};
        for (int i = 0; i < 6; ++i) {
            const int q = body[i / 3];
            if (unknown_[q] >= 0 && give(bodies[q], i % 3) > 0.0)
                force[unknown_[q] + i % 3] += row.weight * missing_[r] * row.along[i];
        }
    }
    const Eigen::VectorXd moved = matrix_.solve(force);
    const auto of = [&](int q) {
        return unknown_[q] < 0 ? Velocity{} : Velocity{moved[unknown_[q]], moved[unknown_[q] + 1], moved[unknown_[q] + 2]};
    };
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        const Row& row = rows_[r];
        Touch& c = touches[row.touch];
        double change[3] = {0.0, 0.0, 0.0};
        change[row.kind] = row.weight * (missing_[r] - velocity_along(row.along, of(c.a), of(c.b)));
        c.p[row.kind] += change[row.kind];
        apply(c, change, bodies, velocity);
    }
}

bool DirectSolver::solve(std::span<Touch> touches, std::span<const Softness> bodies, std::span<Velocity> velocity,
                         double tolerance) {
    list_rows(touches, bodies);
    double before = missing(touches, velocity);
    if (before <= tolerance || unknowns_ == 0 || !factor(touches, bodies)) return false;
    for (int solution = 0; solution < solutions && before > tolerance; ++solution) {
        push(touches, bodies, velocity);
        const double now = missing(touches, velocity);
        if (!(now < before)) return false;  // rounding has the upper hand
        before = now;
    }
    for (Touch& c : touches) {
        double change[3] = {std::max(-c.p[0], 0.0), std::max(-c.p[1], 0.0), 0.0};
        const double bound = c.friction * (std::max(c.p[0], 0.0) + std::max(c.p[1], 0.0)) + c.cohesion;
        change[2] = std::clamp(c.p[2], -bound, bound) - c.p[2];
        if (change[0] == 0.0 && change[1] == 0.0 && change[2] == 0.0) continue;
        for (int k = 0; k < 3; ++k) c.p[k] += change[k];
        apply(c, change, bodies, velocity);
    }
    return true;
}

}  // namespace talus::rigid
