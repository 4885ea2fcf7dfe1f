#include "dynamics/time_step.hpp"

#include "core/errors.hpp"
#include "dynamics/motion.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace {

using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;

// kn and ks that the contacts of each block may have at most.
struct Stiffness {
    std::vector<double> kn, ks;  // [nb] Pa/m
};

Stiffness largest_stiffness(const Model& model) {
    const int nb = model.blocks.size(), nm = static_cast<int>(model.material_names.size());
    Stiffness most{std::vector<double>(nb, 0.0), std::vector<double>(nb, 0.0)};
    const auto raise = [&](BlockId b, int joint) {
        most.kn[b] = std::max(most.kn[b], model.joints[joint].kn);
        most.ks[b] = std::max(most.ks[b], model.joints[joint].ks);
    };
    if (model.joints.empty()) return most;  // one block needs none
    std::vector<bool> present(nm, false);
    for (int m : model.blocks.material) present[m] = true;
    for (BlockId b = 0; b < nb; ++b)
        for (int m = 0; m < nm; ++m)
            if (present[m]) raise(b, model.joint_of_materials[model.blocks.material[b] * nm + m]);
    for (const auto& [pair, joint] : model.joint_of_blocks) raise(pair.a, joint), raise(pair.b, joint);
    for (const auto& [pair, joint] : model.joint_of_faces)
        raise(model.parts.block[pair.a], joint), raise(model.parts.block[pair.b], joint);
    return most;
}

// A stretch of a face as two springs of half its length each: at the Gauss points, which integrate the quadratic exactly,
// for stiffness spread evenly; at its ends for springs at rounded corners.
double inward(const Model& model) { return model.rounding_length > 0.0 ? 1.0 : std::sqrt(3.0); }

// Adds the stiffness of a stretch of length l with middle `arm`.
void add_face(const Model& model, Matrix3& k, const Vec2& arm, const Vec2& normal, double face, double kn, double ks) {
    const Vec2 tangent = perp(normal);
    const double length = face + 2.0 * model.rounding_length;  // no spring of a corner has less than the rounding length
    for (const double at : {-0.5, 0.5}) {
        const Vec2 r = arm + tangent * (at * face / inward(model));
        const Vector3 n(normal.x(), normal.y(), cross(r, normal)), t(tangent.x(), tangent.y(), cross(r, tangent));
        k += 0.5 * length * (kn * n * n.transpose() + ks * t * t.transpose());
    }
}

// visit(k, middle) for every edge on the boundary of a block, with the middle from its centroid.
template <class Visit>
void for_each_edge(const Model& model, const Placed& placed, BlockId b, Visit&& visit) {
    for (PartId p = model.blocks.first_part[b]; p < model.blocks.first_part[b + 1]; ++p) {
        const int begin = model.parts.first_corner[p], end = model.parts.first_corner[p + 1];
        for (int k = begin; k < end; ++k) {
            if (model.corners.internal[k]) continue;
            visit(k, 0.5 * (placed.corner[k].arm + placed.corner[k + 1 == end ? begin : k + 1].arm));
        }
    }
}

double largest_eigenvalue(const Matrix3& k, const Vector3& inverse_mass) {
    const Vector3 root = inverse_mass.cwiseSqrt();
    const Matrix3 scaled = root.asDiagonal() * k * root.asDiagonal();
    return Eigen::SelfAdjointEigenSolver<Matrix3>(scaled, Eigen::EigenvaluesOnly).eigenvalues()[2];
}

Vector3 inverse_mass(const Model& model, BlockId b) {
    return {model.blocks.inv_mass[b].x(), model.blocks.inv_mass[b].y(), model.blocks.inv_inertia[b]};
}

// A spring of the power iteration: one Gauss point of one contact.
struct Spring {
    BlockId a, b;
    Vec2 arm_a, arm_b, normal;
    double kn, ks;
};

std::vector<Spring> springs_of(const Model& model, const State& state) {
    std::vector<Spring> springs;
    for (const Contact& c : state.contacts.list) {
        if (!c.touching) continue;
        const BlockId a = model.parts.block[c.part_a], b = model.parts.block[c.part_b];
        const Vec2 tangent = perp(c.normal);
        const Joint& joint = model.joints[c.joint];
        for (const double at : {-0.5, 0.5}) {
            const Vec2 p = c.point + tangent * (at * c.length / inward(model));
            springs.push_back({a, b, p - state.motion.position[a], p - state.motion.position[b], c.normal,
                               0.5 * joint.kn * c.length, 0.5 * joint.ks * c.length});
        }
    }
    return springs;
}

// Largest omega^2 of the springs. The Rayleigh quotient only rises: it never claims more than there is.
double power_iteration(const Model& model, const std::vector<Spring>& springs) {
    const int nb = model.blocks.size();
    std::vector<Vector3> x(nb), y(nb), root(nb);
    for (BlockId b = 0; b < nb; ++b) {
        root[b] = inverse_mass(model, b).cwiseSqrt();
        const double h = b * 0.6180339887498949;  // a start without symmetry
        x[b] = Vector3(h - std::floor(h) - 0.31, 0.73 - 2.0 * h + std::floor(2.0 * h), 5.0 * h - std::floor(5.0 * h) - 0.47);
        for (int i = 0; i < 3; ++i)
            if (root[b][i] == 0.0) x[b][i] = 0.0;
    }
    double quotient = 0.0;
    for (int iteration = 0; iteration < 300; ++iteration) {
        double size = 0.0;
        for (const Vector3& v : x) size += v.squaredNorm();
        if (size == 0.0) return 0.0;
        for (Vector3& v : x) v /= std::sqrt(size);
        std::fill(y.begin(), y.end(), Vector3::Zero());
        for (const Spring& s : springs) {
            const Vector3 ua = root[s.a].cwiseProduct(x[s.a]), ub = root[s.b].cwiseProduct(x[s.b]);
            const Vec2 d = Vec2(ub.x(), ub.y()) + ub.z() * perp(s.arm_b) - Vec2(ua.x(), ua.y()) - ua.z() * perp(s.arm_a);
            const Vec2 tangent = perp(s.normal);
            const Vec2 f = s.kn * d.dot(s.normal) * s.normal + s.ks * d.dot(tangent) * tangent;
            y[s.b] += root[s.b].cwiseProduct(Vector3(f.x(), f.y(), cross(s.arm_b, f)));
            y[s.a] -= root[s.a].cwiseProduct(Vector3(f.x(), f.y(), cross(s.arm_a, f)));
        }
        double next = 0.0;
        for (int b = 0; b < nb; ++b) next += x[b].dot(y[b]);
        const bool settled = std::abs(next - quotient) <= 1e-7 * next && iteration > 20;
        quotient = next;
        if (settled) break;
        std::swap(x, y);
    }
    return quotient;
}

}  // namespace

double damped_limit(double omega, double beta) {
    if (omega <= 0.0) return std::numeric_limits<double>::infinity();
    const double xi = 0.5 * beta * omega;
    return 2.0 / (omega * (std::hypot(1.0, xi) + xi));  // sqrt(1 + xi^2) - xi, which would be 0 for much damping
}

std::vector<Matrix3> boundary_stiffness(const Model& model, const Placed& placed, const std::vector<std::uint8_t>& removed) {
    const Stiffness most = largest_stiffness(model);
    std::vector<Matrix3> all(model.blocks.size(), Matrix3::Zero());
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (removed[b] || model.blocks.held(b)) continue;
        for_each_edge(model, placed, b, [&](int k, const Vec2& middle) {
            add_face(model, all[b], middle, placed.corner[k].normal, model.corners.length[k], most.kn[b], most.ks[b]);
        });
    }
    return all;
}

std::vector<double> block_limits(const Model& model, const Placed& placed, const State& state) {
    const std::vector<Matrix3> whole = boundary_stiffness(model, placed, state.removed);
    std::vector<double> limits(model.blocks.size(), std::numeric_limits<double>::infinity());
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        const Vector3 free = inverse_mass(model, b);
        if (state.removed[b] || free.isZero()) continue;
        limits[b] = damped_limit(std::sqrt(2.0 * largest_eigenvalue(whole[b], free)), model.contact_damping);
    }
    return limits;
}

double narrowest(const Model& model, const State& state) {
    double width = std::numeric_limits<double>::infinity();
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        for (PartId p = model.blocks.first_part[b]; p < model.blocks.first_part[b + 1]; ++p)
            if (!state.removed[b])
                width = std::min(width, model.parts.thickness[p] * (state.is_fast(b) ? state.substeps : 1));
    return width;
}

StableStep stable_step(const Model& model, const Placed& placed, const State& state) {
    const Stiffness most = largest_stiffness(model);
    const std::vector<double> limits = block_limits(model, placed, state);
    StableStep step;
    step.thinnest = std::numeric_limits<double>::infinity();
    double alone = 0.0;
    step.bound = std::numeric_limits<double>::infinity();
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (state.removed[b]) continue;
        for (PartId p = model.blocks.first_part[b]; p < model.blocks.first_part[b + 1]; ++p)
            step.thinnest = std::min(step.thinnest, model.parts.thickness[p]);
        const Vector3 free = inverse_mass(model, b);
        if (free.isZero()) continue;
        Matrix3 longest = Matrix3::Zero();
        double length = 0.0;
        for_each_edge(model, placed, b, [&](int k, const Vec2& middle) {
            if (model.corners.length[k] <= length) return;
            length = model.corners.length[k];
            longest.setZero();
            add_face(model, longest, middle, placed.corner[k].normal, length, most.kn[b], most.ks[b]);
        });
        if (limits[b] < step.bound) step.bound = limits[b], step.block = b;
        alone = std::max(alone, largest_eigenvalue(longest, free));
    }
    const double found = power_iteration(model, springs_of(model, state));
    step.estimate = std::max(damped_limit(std::sqrt(std::max(alone, found)), model.contact_damping), step.bound);
    return step;
}

int step_halvings(double stage_step, int halvings_now, double speed, double thinnest) {
    int halvings = halvings_now;
    while (speed * std::ldexp(stage_step, -halvings) > 0.25 * thinnest)
        if (++halvings > most_halvings) throw DivergenceError("a block moves at " + std::to_string(speed) + " m/s");
    while (halvings > 0 && speed * std::ldexp(stage_step, -(halvings - 1)) < 0.1 * thinnest) --halvings;
    return halvings;
}

double speed_ahead(const Model& model, double stage_time, double dt) {
    double speed = 0.0;
    for (const DrivenBlock& d : model.driven)
        for (const double t : {stage_time + 0.5 * dt, stage_time + dt})
            speed = std::max(
                speed, std::hypot(d.velocity_x(t), d.velocity_y(t)) + std::abs(d.spin(t)) * model.blocks.radius[d.block]);
    // Those on the boundary press on rock that is pressed back.
    for (std::size_t i = model.boundary_loads; i < model.loads.size(); ++i)
        for (const double t : {stage_time, stage_time + dt}) {
            const Load& l = model.loads[i];
            const Force f = load_at(l, t, 0.0);
            const double gained = f.force.norm() / model.blocks.mass[l.block] +
                                  std::abs(f.torque) / model.blocks.inertia[l.block] * model.blocks.radius[l.block];
            speed = std::max(speed, gained * dt);
        }
    return speed;
}

std::vector<double> sharp_turns(const Model& model, double dt) {
    std::vector<double> turns;
    const auto look = [&](const TimeTable& table) {
        if (table.is_constant()) return;
        const double largest = std::abs(std::ranges::max(table.value, {}, [](double v) { return std::abs(v); }));
        for (const double knot : table.time)
            for (const double begin : {knot - dt, knot - 0.5 * dt, knot}) {
                const double ends = 0.5 * (table(begin) + table(begin + dt));
                if (std::abs(table.mean(begin + 0.5 * dt, dt) - ends) > 0.01 * largest) turns.push_back(knot);
            }
    };
    look(model.gravity_x), look(model.gravity_y);
    for (const Load& l : model.loads) look(l.force_x), look(l.force_y), look(l.moment);
    for (const DrivenBlock& d : model.driven) look(d.velocity_x), look(d.velocity_y), look(d.spin);
    std::ranges::sort(turns);
    turns.erase(std::unique(turns.begin(), turns.end()), turns.end());
    return turns;
}

}  // namespace talus
