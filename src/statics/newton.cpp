#include "statics/newton.hpp"

#include "contact/tangent.hpp"
#include "core/turn.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using VectorX = Eigen::VectorXd;

// Of the scaled masses. What moves freely has pivots of 1e-16, of either sign; a block that gravity turns over has -rho g /
// kn.
constexpr double no_stiffness = 1e-12;
constexpr double probe = 0.1;      // overlaps that a step off an equilibrium is long: contacts that are closed stay closed
constexpr double confirmed = 0.1;  // share of the force predicted that must be met along it
constexpr int shortest = 6;        // halvings of a step: one that has to be shorter than 1/64 goes nowhere

// Number of each free axis of each block among all unknowns; -1 = held.
std::vector<int> number_unknowns(const Model& model, const State& state, int& count) {
    std::vector<int> all(3 * model.blocks.size(), -1);
    count = 0;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (state.removed[b]) continue;
        if (model.blocks.inv_mass[b].x() > 0.0) all[3 * b] = count++;
        if (model.blocks.inv_mass[b].y() > 0.0) all[3 * b + 1] = count++;
        if (model.blocks.inv_inertia[b] > 0.0) all[3 * b + 2] = count++;
    }
    return all;
}

}  // namespace

struct Newton::System {
    std::vector<int> unknown;
    int size = 0;
    Sparse matrix;
    VectorX force;
    bool symmetric = true;
    Eigen::SimplicialLDLT<Sparse> ldlt;
    Eigen::SparseLU<Sparse> lu;
    std::vector<int> ldlt_outer, ldlt_inner, lu_outer, lu_inner;  // patterns they were analysed for

    void assemble(const Model& model, const Placed& placed, const ScaledMass& mass, const State& state, double shift,
                  Shear shear);
    bool solve(VectorX& x);
    /// The lowest pivot below zero, and a direction with this stiffness; 0 if there is none.
    double weakest(VectorX& x);

private:
    int lowest_pivot() const;  // of those of LDL^T that are negative, as a share of its diagonal; -1 = none
    bool known(std::vector<int>& outer, std::vector<int>& inner) const {
        const int *o = matrix.outerIndexPtr(), *i = matrix.innerIndexPtr();
        const auto columns = matrix.outerSize() + 1;
        const auto entries = matrix.nonZeros();
        if (std::equal(o, o + columns, outer.begin(), outer.end()) && std::equal(i, i + entries, inner.begin(), inner.end()))
            return true;
        outer.assign(o, o + columns);
        inner.assign(i, i + entries);
        return false;
    }
};

void Newton::System::assemble(const Model& model, const Placed& placed, const ScaledMass& mass, const State& state,
                              double shift, Shear shear) {
    unknown = number_unknowns(model, state, size);
    const std::vector<Contact>& list = state.contacts.list;
    const int n = static_cast<int>(list.size());
    std::vector<Tangent> tangent(n);
#pragma omp parallel for schedule(dynamic, 64)
    for (int i = 0; i < n; ++i)
        if (list[i].touching)
            tangent[i] = contact_tangent(model, placed, state.contacts.broken, list[i], state.contacts.reaction[i], shear);
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](int row, int column, double value) {
        if (row >= 0 && column >= 0) entries.emplace_back(row, column, value);
    };
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) add(unknown[3 * b + i], unknown[3 * b + j], shift * mass.mass(b)(i, j));
    for (const Load& l : model.loads) {  // a force at an arm: the torque falls by arm . force with the angle
        const Vec2 arm = turned(l.arm, state.motion.angle[l.block]);
        const int angle = unknown[3 * l.block + 2];
        add(angle, angle, arm.dot(Vec2(l.force_x(state.stage_time), l.force_y(state.stage_time))));
    }
    symmetric = true;
    for (int c = 0; c < n; ++c) {
        if (!list[c].touching) continue;
        symmetric = symmetric && tangent[c].symmetric;
        const BlockId block[2] = {model.parts.block[list[c].part_a], model.parts.block[list[c].part_b]};
        for (int i = 0; i < 6; ++i)
            for (int j = 0; j < 6; ++j)
                add(unknown[3 * block[i / 3] + i % 3], unknown[3 * block[j / 3] + j % 3], tangent[c].stiffness(i, j));
    }
    matrix.resize(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    force.resize(size);
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        const double f[3] = {state.load[b].force.x(), state.load[b].force.y(), state.load[b].torque};
        for (int i = 0; i < 3; ++i)
            if (unknown[3 * b + i] >= 0) force[unknown[3 * b + i]] = f[i];
    }
}

bool Newton::System::solve(VectorX& x) {
    if (symmetric) {
        if (!known(ldlt_outer, ldlt_inner)) ldlt.analyzePattern(matrix);
        ldlt.factorize(matrix);
        if (ldlt.info() != Eigen::Success) return false;
        x = ldlt.solve(force);
    } else {
        if (!known(lu_outer, lu_inner)) lu.analyzePattern(matrix);
        lu.factorize(matrix);
        if (lu.info() != Eigen::Success) return false;
        x = lu.solve(force);
    }
    return x.allFinite();
}

// L^T x = e_j has x . K x = D_j.
double Newton::System::weakest(VectorX& x) {
    if (!known(ldlt_outer, ldlt_inner)) ldlt.analyzePattern(matrix);
    ldlt.factorize(matrix);
    const int j = ldlt.info() == Eigen::Success ? lowest_pivot() : -1;
    if (j < 0) return 0.0;
    x = ldlt.permutationPinv() * ldlt.matrixU().solve(VectorX::Unit(size, j)).eval();
    return x.allFinite() ? ldlt.vectorD()[j] : 0.0;
}

int Newton::System::lowest_pivot() const {
    if (size == 0) return -1;
    const VectorX scale = ldlt.permutationP() * matrix.diagonal().eval();
    Eigen::Index j = 0;
    return (ldlt.vectorD().array() / scale.array().abs()).minCoeff(&j) < -no_stiffness ? static_cast<int>(j) : -1;
}

Newton::Newton() : system_(std::make_unique<System>()) {}
Newton::~Newton() = default;

namespace {

// What a trial changes.
struct Before {
    Motion motion;
    Contacts contacts;
    std::vector<Force> load;
    Ledger ledger;

    explicit Before(const State& state)
        : motion(state.motion), contacts(state.contacts), load(state.load), ledger(state.ledger) {}
    void put_back(State& state, const Forces& forces) const {
        state.motion = motion;
        state.contacts = contacts;
        state.load = load;
        state.ledger = ledger;
        forces.put_back();
    }
};

void set_rates(const std::vector<int>& unknown, const VectorX& x, Motion& motion) {
    for (std::size_t b = 0; b < motion.velocity.size(); ++b) {
        const auto at = [&](int i) { return unknown[3 * b + i] < 0 ? 0.0 : x[unknown[3 * b + i]]; };
        motion.velocity[b] = {at(0), at(1)};
        motion.spin[b] = at(2);
    }
}

// m, overlap of the contacts of the block that these rates move furthest.
double overlap_on_the_way(const Model& model, const State& state, const Motion& way) {
    BlockId most = 0;
    double furthest = 0.0, overlap = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        const double size = way.velocity[b].norm() + std::abs(way.spin[b]) * model.blocks.radius[b];
        if (size > furthest) furthest = size, most = b;
    }
    for (const Contact& c : state.contacts.list.read())
        if (model.parts.block[c.part_a] == most || model.parts.block[c.part_b] == most)
            overlap = std::max(overlap, c.overlap);
    return overlap > 0.0 ? overlap : 1e-6 * model.blocks.radius[most];
}

// J, what a change of the load does along these rates.
double work(const Motion& way, const std::vector<Force>& after, const std::vector<Force>& before) {
    double sum = 0.0;
    for (std::size_t b = 0; b < after.size(); ++b)
        sum += way.velocity[b].dot(after[b].force - before[b].force) + way.spin[b] * (after[b].torque - before[b].torque);
    return sum;
}

}  // namespace

void move(double share, const Motion& way, Motion& motion) {
    for (std::size_t b = 0; b < way.velocity.size(); ++b) {
        motion.velocity[b] = share * way.velocity[b];
        motion.spin[b] = share * way.spin[b];
        motion.position[b] += motion.velocity[b];
        motion.angle[b] += motion.spin[b];
    }
}

bool Newton::unstable(const Model& model, const ScaledMass& mass, const Placed& placed, const Forces& forces, State& state,
                      Motion& way) {
    System& s = *system_;
    s.assemble(model, placed, mass, state, no_stiffness, Shear::sticks);
    VectorX x;
    const double stiffness = s.weakest(x);
    if (stiffness >= 0.0) return false;
    way = state.motion;
    set_rates(s.unknown, x, way);
    double length = probe * overlap_on_the_way(model, state, way) / largest_rate(model, way), back = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        back += way.velocity[b].dot(state.statics.start[b] - state.motion.position[b]);
    if (back < 0.0) length = -length;
    set_rates(s.unknown, length * x, way);
    const Before before(state);
    for (const double side : {1.0, -1.0}) {
        move(side, way, state.motion);
        forces.evaluate();
        const double gained = side * work(way, state.load, before.load);
        before.put_back(state, forces);
        if (gained > -confirmed * stiffness * length * length) return true;
    }
    return false;
}

bool Newton::improve(const Model& model, const ScaledMass& mass, const Placed& placed, double longest, const Forces& forces,
                     State& state) {
    System& s = *system_;
    s.assemble(model, placed, mass, state, state.statics.shift, Shear::by_the_law);
    VectorX x;
    Before before(state);
    const double unbalanced = unbalanced_energy(mass, state.load);
    double& shift = state.statics.shift;
    if (s.solve(x)) {
        set_rates(s.unknown, x, before.motion);
        const double largest = largest_rate(model, before.motion);
        double share = largest > longest ? longest / largest : 1.0;
        for (int i = 0; i <= shortest; ++i, share *= 0.5) {
            move(share, before.motion, state.motion);
            forces.evaluate();
            if (unbalanced_energy(mass, state.load) <= (1.0 - 0.2 * share) * unbalanced) {
                shift = shift > 1e-13 ? 0.1 * shift : 0.0;
                return true;
            }
            before.put_back(state, forces);
        }
    }
    std::ranges::fill(state.motion.velocity, Vec2::Zero());
    std::ranges::fill(state.motion.spin, 0.0);
    shift = std::clamp(100.0 * shift, 1e-9, 1e-1);
    return false;
}

}  // namespace talus
