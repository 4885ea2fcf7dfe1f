// One observed number: what a history records and what an expectation judges.
#pragma once

#include "model/measure.hpp"
#include "model/model.hpp"
#include "model/state.hpp"
#include "scenario/scenario.hpp"

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace talus {

/// What a probe reads besides model and state; the run fills in what `Probe::needs_energies` and the names ask for.
struct Gauges {
    Energies energies;
    double time_step = 0.0, stable_step = 0.0;  // s, in use; estimate of the largest stable one
    double energy_gain = 0.0;                   // 1, see Simulation::energy_gain
};

/// What a probe has to know of earlier readings: a run that is resumed takes it with it.
class ProbeMemory {
public:
    virtual ~ProbeMemory() = default;
    virtual std::vector<double> values() const = 0;
    virtual void restore(std::span<const double> values) = 0;  // such as `values` gave
};

/// Found once at the start and read at any step after; it follows its block or its joint, not its place.
struct Probe {
    std::string name;  // "displacement.x at (30, 15)", in the user's coordinates
    std::string unit;  // SI, "1" for plain numbers
    bool needs_energies = false;
    std::function<double(const Model&, const State&, const Gauges&)> read;
    std::shared_ptr<ProbeMemory> memory = nullptr;  // mostly none
};

/// Throws InputError for a quantity or component that does not exist, or a place or block that fits nothing.
///
/// displacement, velocity, position, rotation, spin: of the material point, or of the centroid of the named block.
/// normal_force, shear_force, normal_stress, max_normal_stress, shear_stress, contact_length, utilisation, slip, opening,
/// shear_displacement: of the joint between the two parts nearest to the place. The first block is the one with the lower
/// number; shear is positive when it pushes the second block to the left of the normal from first to second, shear
/// displacement when the second block has moved that way. A joint that is open carries nothing.
/// reaction, moment: sum of the contact forces on the block, and of their torques about its centroid.
/// max_displacement, relative_displacement without a place: of free blocks, over their size (square root of the area).
/// area: of a block, or of all that are there.
/// energy, energy_drift, energy_gain, momentum, angular_momentum (about the origin of the file), unbalanced, max_speed,
/// max_overlap, slip_changes, time_step, stable_step: of the whole scene.
Probe make_probe(const ProbeSpec& spec, const Model& model, const State& state);

/// The block that a point or a name means. Throws InputError if there is none.
BlockId observed_block(const ProbeSpec& spec, const Model& model, const State& state);

}  // namespace talus
