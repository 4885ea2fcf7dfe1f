#include "rigid/bonds.hpp"

#include "core/turn.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace talus::rigid {
namespace {

// Below this share of the stress of its surroundings a pull is rounding: 1e-9 is far above it, and far below what breaks.
constexpr double rounding = 1e-9;

struct Cells {                                       // the intact ones of a face
    double length = 0.0, first = 0.0, second = 0.0;  // m, m2, m3: moments about the start of edge a
};

Cells intact_cells(const JointFace& face, int cells, std::span<const std::uint8_t> broken) {
    Cells sum;
    const double length = (face.s1 - face.s0) / cells;
    for (int i = 0; i < cells; ++i) {
        if (broken[face.first_cell + i]) continue;
        const double lo = face.s0 + i * length, hi = lo + length;
        sum.length += length;
        sum.first += 0.5 * (hi * hi - lo * lo);
        sum.second += (hi * hi * hi - lo * lo * lo) / 3.0;
    }
    return sum;
}

/// Rows of the relative displacement of b against a at the middle of a face: along the normal, along its tangent, turning;
/// unknowns (x, y, turn) of a, then of b.
template <class Face>
std::array<Eigen::Matrix<double, 6, 1>, 3> rows(const Face& f) {
    const Vec2 n = f.normal, t = perp(f.normal);
    std::array<Eigen::Matrix<double, 6, 1>, 3> g;
    g[0] << -n.x(), -n.y(), -cross(f.arm_a, n), n.x(), n.y(), cross(f.arm_b, n);
    g[1] << -t.x(), -t.y(), -cross(f.arm_a, t), t.x(), t.y(), cross(f.arm_b, t);
    g[2] << 0.0, 0.0, -1.0, 0.0, 0.0, 1.0;
    return g;
}

}  // namespace

Bonds::Bonds(const Model& model, const State& state, const Bodies& bodies) {
    const int nb = model.blocks.size();
    unknown_.assign(nb, -1);
    for (int q = 0; q < bodies.size(); ++q) {
        if (bodies.single(q)) continue;
        bool fixed = false;  // the first block holds the others if none is held
        for (int i = bodies.first[q]; i < bodies.first[q + 1]; ++i) fixed |= model.blocks.held(bodies.member[i]);
        for (int i = bodies.first[q]; i < bodies.first[q + 1]; ++i) {
            const BlockId b = bodies.member[i];
            if (fixed ? !model.blocks.held(b) : i > bodies.first[q]) unknown_[b] = unknowns_++;
        }
    }
    for (std::size_t i = 0; i < state.contacts.list.size(); ++i) {
        const Contact& c = state.contacts.list[i];
        const BlockId a = model.parts.block[c.part_a], b = model.parts.block[c.part_b];
        if (bodies.body_of[a] != bodies.body_of[b] || !holds(model, state, c)) continue;
        const JointFace& face = model.faces[c.face];
        const Joint& joint = model.joints[c.joint];
        const Cells cells = intact_cells(face, joint.cells, state.contacts.broken);
        const double middle = cells.first / cells.length;
        Face f{};
        f.slot = static_cast<int>(i);
        f.face = c.face;
        f.a = unknown_[a], f.b = unknown_[b];
        f.normal = model.corners.normal[face.edge_a];
        f.arm_a = model.corners.arm[face.edge_a] + middle * perp(f.normal);
        f.arm_b = f.arm_a + model.blocks.start[a] - model.blocks.start[b];
        f.length = cells.length;
        f.kn = joint.kn * cells.length;
        f.ks = joint.ks * cells.length;
        f.kr = joint.kn * (cells.second - cells.first * middle);
        faces_.push_back(f);
    }
    if (unknowns_ > 0) factor();
}

void Bonds::find_slots(const State& state) {
    std::size_t next = 0;  // faces lie in the order of the list
    for (std::size_t i = 0; i < state.contacts.list.size() && next < faces_.size(); ++i) {
        if (state.contacts.list[i].face == faces_[next].face) faces_[next++].slot = static_cast<int>(i);
    }
}

void Bonds::factor() {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(36 * faces_.size());
    for (const Face& f : faces_) {
        Eigen::Matrix<double, 6, 6> k = Eigen::Matrix<double, 6, 6>::Zero();
        const auto g = rows(f);
        k += f.kn * g[0] * g[0].transpose() + f.ks * g[1] * g[1].transpose() + f.kr * g[2] * g[2].transpose();
        const auto place = [&](int i) { return i < 3 ? (f.a < 0 ? -1 : 3 * f.a + i) : (f.b < 0 ? -1 : 3 * f.b + i - 3); };
        for (int i = 0; i < 6; ++i)
            for (int j = 0; j < 6; ++j)
                if (place(i) >= place(j) && place(j) >= 0) entries.emplace_back(place(i), place(j), k(i, j));
    }
    Eigen::SparseMatrix<double> matrix(3 * unknowns_, 3 * unknowns_);
    matrix.setFromTriplets(entries.begin(), entries.end());
    stiffness_ = std::make_unique<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>>(matrix);
}

// Whether what the bonds carried last still holds the loads well enough: to a thousandth of the largest one; where no bond
// comes near to its strength, to a twentieth for a few steps.
bool Bonds::balanced(const Model& model, std::span<const Force> load, const State& state) {
    left_over_.assign(load.begin(), load.end());
    double used = 0.0;  // share of the strength, the largest
    for (const Face& f : faces_) {
        const Contact& c = state.contacts.list[f.slot];
        const Joint& joint = model.joints[c.joint];
        const double bending = std::abs(c.moment) * 0.5 * f.length * joint.kn / f.kr, mean = c.normal_force / f.length;
        used = std::max({used, std::abs(c.shear_force) / c.strength, (bending - mean) / joint.tension});
        const Reaction& r = state.contacts.reaction[f.slot];
        Force &a = left_over_[model.parts.block[c.part_a]], &b = left_over_[model.parts.block[c.part_b]];
        a.force -= r.force;
        a.torque += r.torque_a;
        b.force += r.force;
        b.torque += r.torque_b;
    }
    double largest = 0.0, left = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (unknown_[b] < 0) continue;
        const double arm = model.blocks.radius[b];
        largest = std::max(largest, load[b].force.norm() + std::abs(load[b].torque) / arm);
        left = std::max(left, left_over_[b].force.norm() + std::abs(left_over_[b].torque) / arm);
    }
    const bool patient = used < 0.5 && state.total_steps % 10 != 0;
    return left <= (patient ? 0.05 : 1e-3) * largest;
}

int Bonds::carry(const Model& model, std::span<const Force> load, State& state) {
    if (balanced(model, load, state)) return 0;
    Eigen::VectorXd force(3 * unknowns_);
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (unknown_[b] < 0) continue;
        const Turn back = turn(-state.motion.angle[b]);  // the body as it was built
        const Vec2 f = turned(load[b].force, back);
        force.segment<3>(3 * unknown_[b]) << f.x(), f.y(), load[b].torque;
    }
    const Eigen::VectorXd moved = unknowns_ > 0 ? Eigen::VectorXd(stiffness_->solve(force)) : force;
    int broken_faces = 0;
    for (const Face& f : faces_) {
        Contact& c = state.contacts.list[f.slot];
        const Joint& joint = model.joints[c.joint];
        const JointFace& face = model.faces[c.face];
        Eigen::Matrix<double, 6, 1> u = Eigen::Matrix<double, 6, 1>::Zero();
        if (f.a >= 0) u.head<3>() = moved.segment<3>(3 * f.a);
        if (f.b >= 0) u.tail<3>() = moved.segment<3>(3 * f.b);
        const auto g = rows(f);
        const double normal = -f.kn * g[0].dot(u), shear = -f.ks * g[1].dot(u), turning = g[2].dot(u);
        const double mean = normal / f.length, steep = joint.kn * turning;  // Pa, Pa/m: pressure mean + steep (s - middle)

        const BlockId a = model.parts.block[c.part_a];
        const Turn now = turn(state.motion.angle[a]);
        c.normal = turned(f.normal, now);
        c.touching = c.alive = 1;
        c.sliding = 0;
        c.edge_a = face.edge_a, c.edge_b = face.edge_b;
        c.length = f.length;
        c.overlap = 0.0;
        c.normal_force = normal;
        c.shear_force = shear;
        c.shear_energy = 0.0;
        c.strength = joint.cohesion * f.length + joint.tan_friction * std::max(normal, 0.0);
        c.moment = f.kr * turning;
        const double centre = normal > 0.0 ? std::clamp(c.moment / normal, -0.5 * f.length, 0.5 * f.length) : 0.0;
        const Vec2 arm = turned(f.arm_a, now), from_b = turned(f.arm_b, now);
        c.point = state.motion.position[a] + arm + centre * perp(c.normal);
        const Vec2 total = normal * c.normal + shear * perp(c.normal);
        // Pressure at s along perp(normal) turns b by -s x its share.
        state.contacts.reaction[f.slot] = {total, -cross(arm, total) + c.moment, cross(from_b, total) - c.moment};

        const double stress = std::abs(mean) + std::abs(steep) * f.length + std::abs(shear) / f.length;
        bool broke = false;
        if (std::abs(shear) > c.strength + rounding * stress * f.length) {
            broke = true;
            c.slipped = 1;
            for (int i = 0; i < joint.cells && joint.weakens; ++i) {
                std::uint8_t& cell = state.contacts.broken[face.first_cell + i];
                if (!cell) cell = 2;
            }
        }
        const double length = (face.s1 - face.s0) / joint.cells;
        const Cells cells = intact_cells(face, joint.cells, state.contacts.broken);
        const double middle = cells.length > 0.0 ? cells.first / cells.length : 0.0;
        for (int i = 0; i < joint.cells; ++i) {
            std::uint8_t& cell = state.contacts.broken[face.first_cell + i];
            const double lo = face.s0 + i * length - middle, hi = lo + length;
            if (cell || std::min(mean + steep * lo, mean + steep * hi) >= -joint.tension - rounding * stress) continue;
            cell = 1;
            broke = true;
        }
        if (broke) {
            ++broken_faces;
            if (!holds(model, state, c)) c.slipped = 1;  // all of it has gone: residual strength
        }
    }
    // What was left has to be found anew with fewer bonds.
    if (broken_faces > 0)
        for (const Face& f : faces_) state.contacts.reaction[f.slot] = {};
    return broken_faces;
}

}  // namespace talus::rigid
