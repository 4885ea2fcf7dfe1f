#include "statics/newton.hpp"

#include "contact/tangent.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using VectorX = Eigen::VectorXd;

constexpr int shortest = 6;  // halvings of a step: one that has to be shorter than 1/64 goes nowhere

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

    void assemble(const Model& model, const Placed& placed, const ScaledMass& mass, const State& state);
    bool solve(VectorX& x);

private:
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

void Newton::System::assemble(const Model& model, const Placed& placed, const ScaledMass& mass, const State& state) {
    unknown = number_unknowns(model, state, size);
    const std::vector<Contact>& list = state.contacts.list;
    const int n = static_cast<int>(list.size());
    std::vector<Tangent> tangent(n);
#pragma omp parallel for schedule(dynamic, 64)
    for (int i = 0; i < n; ++i)
        if (list[i].touching)
            tangent[i] = contact_tangent(model, placed, state.contacts.broken, list[i], state.contacts.reaction[i]);
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](int row, int column, double value) {
        if (row >= 0 && column >= 0) entries.emplace_back(row, column, value);
    };
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                add(unknown[3 * b + i], unknown[3 * b + j], state.statics.shift * mass.mass(b)(i, j));
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

}  // namespace

bool Newton::improve(const Model& model, const ScaledMass& mass, const Placed& placed, double longest, const Forces& forces,
                     State& state) {
    System& s = *system_;
    s.assemble(model, placed, mass, state);
    VectorX x;
    Before before(state);
    const double unbalanced = unbalanced_energy(mass, state.load);
    double& shift = state.statics.shift;
    if (s.solve(x)) {
        for (BlockId b = 0; b < model.blocks.size(); ++b) {
            const auto at = [&](int i) { return s.unknown[3 * b + i] < 0 ? 0.0 : x[s.unknown[3 * b + i]]; };
            before.motion.velocity[b] = {at(0), at(1)};
            before.motion.spin[b] = at(2);
        }
        const double largest = largest_rate(model, before.motion);
        double share = largest > longest ? longest / largest : 1.0;
        for (int i = 0; i <= shortest; ++i, share *= 0.5) {
            for (BlockId b = 0; b < model.blocks.size(); ++b) {
                state.motion.velocity[b] = share * before.motion.velocity[b];
                state.motion.spin[b] = share * before.motion.spin[b];
                state.motion.position[b] += state.motion.velocity[b];
                state.motion.angle[b] += state.motion.spin[b];
            }
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
