// Masses of the relaxation: not those of the blocks, but such that a step of 1 is as long as it may be for every block at
// once.
#pragma once

#include "dynamics/time_step.hpp"

#include <span>
#include <vector>

namespace talus {

/// M' = (1.1 / 2) K_ii of boundary_stiffness, for x, y and the angle of each block. The stiffness matrix lies below twice
/// its block diagonal, so omega^2 <= 4 / 1.1 and steps of 1 are stable whatever touches. Blocks that meet nothing stiff keep
/// their own mass; removed ones and held axes have none.
class ScaledMass {
public:
    ScaledMass(const Model& model, const std::vector<std::uint8_t>& removed);

    void turn_to(std::span<const double> angles);  // [nb] rad: blocks take their masses along as they turn

    const Eigen::Matrix3d& mass(BlockId b) const { return mass_[b]; }
    const Eigen::Matrix3d& inverse(BlockId b) const { return inverse_[b]; }  // zero along held axes
    int size() const { return static_cast<int>(mass_.size()); }

private:
    std::vector<Eigen::Matrix3d> unturned_, mass_, inverse_;
    std::vector<Eigen::Array3d> free_;  // 1 or 0
};

/// sum over all blocks of F . M'^-1 F, J: how far out of balance all is, forces and torques together.
double unbalanced_energy(const ScaledMass& mass, std::span<const Force> load);

inline Eigen::Vector3d components(const Force& f) { return {f.force.x(), f.force.y(), f.torque}; }
inline Eigen::Vector3d rate_of(const Motion& motion, BlockId b) {
    return {motion.velocity[b].x(), motion.velocity[b].y(), motion.spin[b]};
}

}  // namespace talus
