#include "model/probe.hpp"

#include "model/placed_joint.hpp"
#include "scenario/quantities.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <sstream>
#include <utility>
#include <vector>

namespace talus {
namespace {

using Reading = std::function<double(const Model&, const State&, const Gauges&)>;

[[noreturn]] void refuse(const ProbeSpec& spec, const std::string& message) {
    throw InputError({Fault{spec.where, spec.key, message}});
}

// ---- a material point ----------------------------------------------------------------------------------------------

BlockId named_block(const ProbeSpec& spec, const Model& model) {
    const auto found = std::find(model.blocks.name.begin(), model.blocks.name.end(), spec.block);
    if (found == model.blocks.name.end()) refuse(spec, "there is no block named '" + spec.block + "'");
    return static_cast<BlockId>(found - model.blocks.name.begin());
}

MaterialPoint observed_point(const ProbeSpec& spec, const Model& model, const State& state) {
    if (spec.point) {
        const BlockId block = spec.block.empty() ? block_at(model, state, *spec.point) : named_block(spec, model);
        if (block < 0) refuse(spec, "no block contains the point");
        return fixed_to(state, block, *spec.point);
    }
    if (spec.block.empty()) refuse(spec, "needs a point or a block");
    return {named_block(spec, model), Vec2::Zero()};
}

/// The number that a component takes from a vector.
std::function<double(const Vec2&)> component_of(const ProbeSpec& spec) {
    if (spec.component == "x") return [](const Vec2& v) { return v.x(); };
    if (spec.component == "y") return [](const Vec2& v) { return v.y(); };
    if (spec.component.empty() || spec.component == "magnitude") return [](const Vec2& v) { return v.norm(); };
    if (spec.component == "along") {
        const Vec2 direction(std::cos(spec.direction), std::sin(spec.direction));
        return [direction](const Vec2& v) { return v.dot(direction); };
    }
    refuse(spec, "unknown component '" + spec.component + "'; allowed are x, y, magnitude, along");
}

Reading of_motion(const ProbeSpec& spec, const Model& model, const State& state) {
    const MaterialPoint point = observed_point(spec, model, state);
    if (spec.quantity == "rotation")
        return
            [b = point.block](const Model&, const State& s, const Gauges&) { return s.motion.angle[b] - s.start_angle[b]; };
    if (spec.quantity == "spin")
        return [b = point.block](const Model&, const State& s, const Gauges&) { return s.motion.spin[b]; };
    if (spec.quantity == "relative_displacement")
        return [point, size = std::sqrt(model.blocks.area[point.block])](const Model&, const State& s, const Gauges&) {
            return point.displacement(s).norm() / size;
        };
    if (spec.quantity == "area")
        return [b = point.block](const Model& m, const State&, const Gauges&) { return m.blocks.area[b]; };
    const auto part = component_of(spec);
    if (spec.quantity == "velocity")
        return [=](const Model&, const State& s, const Gauges&) { return part(point.velocity(s)); };
    if (spec.quantity == "position")
        return [=](const Model& m, const State& s, const Gauges&) { return part(point.now(s) + m.origin); };
    return [=](const Model&, const State& s, const Gauges&) { return part(point.displacement(s)); };
}

// ---- a joint -------------------------------------------------------------------------------------------------------

double of_contact(const std::string& quantity, const Model& m, const State& s, const Contact& c) {
    if (quantity == "normal_force") return c.normal_force;
    if (quantity == "shear_force") return c.shear_force;
    if (quantity == "normal_stress") return c.length > 0.0 ? c.normal_force / c.length : 0.0;
    if (quantity == "shear_stress") return c.length > 0.0 ? c.shear_force / c.length : 0.0;
    if (quantity == "max_normal_stress") return max_normal_stress(m, s, c);
    if (quantity == "contact_length") return c.length;
    if (quantity == "slip") return c.slip;
    return c.strength > 0.0 ? std::abs(c.shear_force) / c.strength : 0.0;  // utilisation
}

Reading of_joint(const ProbeSpec& spec, const Model& model, const State& state) {
    if (!spec.joint) refuse(spec, "needs the place of a joint");
    if (model.blocks.size() < 2) refuse(spec, "there is no joint in a scene of one block");
    const PlacedJoint joint = joint_near(model, state, *spec.joint);
    if (spec.quantity == "opening") return [joint](const Model&, const State& s, const Gauges&) { return joint.opening(s); };
    if (spec.quantity == "shear_displacement")
        return [joint](const Model&, const State& s, const Gauges&) { return joint.shear_displacement(s); };
    return [joint, quantity = spec.quantity](const Model& m, const State& s, const Gauges&) {
        const Contact* contact = joint.contact(s);
        return contact ? of_contact(quantity, m, s, *contact) : 0.0;
    };
}

// ---- a block or the whole scene ------------------------------------------------------------------------------------

Force contact_forces_on(const Model& model, const State& state, BlockId block) {
    Force sum;
    for (std::size_t i = 0; i < state.contacts.list.size(); ++i) {
        const Reaction& r = state.contacts.reaction[i];
        if (model.parts.block[state.contacts.list[i].part_a] == block) sum.force -= r.force, sum.torque += r.torque_a;
        if (model.parts.block[state.contacts.list[i].part_b] == block) sum.force += r.force, sum.torque += r.torque_b;
    }
    return sum;
}

double largest_displacement(const Model& model, const State& state, bool per_size) {
    double largest = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (model.blocks.held(b) || state.removed[b]) continue;
        const double moved = (state.motion.position[b] - state.start_position[b]).norm();
        largest = std::max(largest, per_size ? moved / std::sqrt(model.blocks.area[b]) : moved);
    }
    return largest;
}

Reading of_support(const ProbeSpec& spec, const Model& model, const State& state) {
    const BlockId block = observed_point(spec, model, state).block;
    if (spec.quantity == "moment")
        return [block](const Model& m, const State& s, const Gauges&) { return contact_forces_on(m, s, block).torque; };
    return [block, part = component_of(spec)](const Model& m, const State& s, const Gauges&) {
        return part(contact_forces_on(m, s, block).force);
    };
}

// Axes along which it is neither held nor driven.
Vec2 free(const Model& model, BlockId b) { return (model.blocks.inv_mass[b].array() > 0.0).cast<double>(); }

Vec2 momentum(const Model& model, const State& state) {
    Vec2 sum = Vec2::Zero();
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        sum += model.blocks.mass[b] * free(model, b).cwiseProduct(state.motion.velocity[b]);
    return sum;
}

double angular_momentum(const Model& model, const State& state) {
    double sum = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        sum += (model.blocks.inv_inertia[b] > 0.0 ? model.blocks.inertia[b] * state.motion.spin[b] : 0.0) +
               model.blocks.mass[b] *
                   cross(state.motion.position[b] + model.origin, free(model, b).cwiseProduct(state.motion.velocity[b]));
    return sum;
}

double total_area(const Model& model, const State& state) {
    double sum = 0.0;
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        if (!state.removed[b]) sum += model.blocks.area[b];
    return sum;
}

double largest_overlap(const State& state) {
    double largest = 0.0;
    for (const Contact& c : state.contacts.list)
        if (c.touching) largest = std::max(largest, c.overlap);
    return largest;
}

/// Counts the contacts that slide now and did not when it was read last, and the other way round.
class SlipChanges final : public ProbeMemory {
public:
    std::vector<double> values() const override {
        std::vector<double> all{static_cast<double>(count_)};
        for (const auto& [a, b] : sliding_) all.insert(all.end(), {static_cast<double>(a), static_cast<double>(b)});
        return all;
    }
    void restore(std::span<const double> values) override {
        count_ = static_cast<std::size_t>(values[0]);
        sliding_.clear();
        for (std::size_t i = 1; i + 1 < values.size(); i += 2)
            sliding_.push_back({static_cast<PartId>(values[i]), static_cast<PartId>(values[i + 1])});
    }
    double operator()(const State& state) {
        if (state.step == 0) count_ = 0, sliding_.clear();
        now_.clear();
        for (const Contact& c : state.contacts.list)
            if (c.sliding) now_.push_back({c.part_a, c.part_b});
        changed_.clear();
        std::set_symmetric_difference(now_.begin(), now_.end(), sliding_.begin(), sliding_.end(),
                                      std::back_inserter(changed_));
        std::swap(now_, sliding_);
        return static_cast<double>(count_ += changed_.size());
    }

private:
    std::vector<std::pair<PartId, PartId>> sliding_, now_, changed_;  // in the order of the list
    std::size_t count_ = 0;
};

Reading of_scene(const ProbeSpec& spec) {
    if (spec.quantity == "momentum")
        return [part = component_of(spec)](const Model& m, const State& s, const Gauges&) { return part(momentum(m, s)); };
    if (spec.quantity == "angular_momentum")
        return [](const Model& m, const State& s, const Gauges&) { return angular_momentum(m, s); };
    if (spec.quantity == "max_speed") return [](const Model& m, const State& s, const Gauges&) { return max_speed(m, s); };
    if (spec.quantity == "max_displacement" || spec.quantity == "relative_displacement")
        return [per_size = spec.quantity == "relative_displacement"](const Model& m, const State& s, const Gauges&) {
            return largest_displacement(m, s, per_size);
        };
    if (spec.quantity == "max_overlap")
        return [](const Model&, const State& s, const Gauges&) { return largest_overlap(s); };
    if (spec.quantity == "area") return [](const Model& m, const State& s, const Gauges&) { return total_area(m, s); };
    if (spec.quantity == "energy_gain") return [](const Model&, const State&, const Gauges& g) { return g.energy_gain; };
    if (spec.quantity == "time_step") return [](const Model&, const State&, const Gauges& g) { return g.time_step; };
    if (spec.quantity == "equilibrium")
        return [](const Model&, const State& s, const Gauges&) { return static_cast<double>(s.statics.now.reached); };
    if (spec.quantity == "stable_step") return [](const Model&, const State&, const Gauges& g) { return g.stable_step; };
    return [](const Model& m, const State& s, const Gauges&) { return unbalanced_ratio(m, s); };
}

/// Change of the total since the last reset over the largest energy that has moved.
class EnergyDrift final : public ProbeMemory {
public:
    std::vector<double> values() const override { return {total_, largest_}; }
    void restore(std::span<const double> values) override { total_ = values[0], largest_ = values[1]; }
    double operator()(const State& state, const Energies& e) {
        if (state.step == 0 || largest_ < 0.0) total_ = e.total(), largest_ = 0.0;
        for (const double moved : {e.kinetic, e.strain_normal + e.strain_shear, e.friction, e.gravity, e.loads, e.driven})
            largest_ = std::max(largest_, std::abs(moved));
        return largest_ > 0.0 ? (e.total() - total_) / largest_ : 0.0;
    }

private:
    double total_ = 0.0, largest_ = -1.0;  // J; not begun while negative
};

Reading of_energy(const ProbeSpec& spec) {
    const auto reading = [](auto part) {
        return [part](const Model&, const State&, const Gauges& g) { return part(g.energies); };
    };
    if (spec.component.empty() || spec.component == "total") return reading([](const Energies& e) { return e.total(); });
    if (spec.component == "strain") return reading([](const Energies& e) { return e.strain_normal + e.strain_shear; });
    static const std::map<std::string, double Energies::*> parts{{"kinetic", &Energies::kinetic},
                                                                 {"strain_normal", &Energies::strain_normal},
                                                                 {"strain_shear", &Energies::strain_shear},
                                                                 {"friction", &Energies::friction},
                                                                 {"contact_damping", &Energies::contact_damping},
                                                                 {"local_damping", &Energies::local_damping},
                                                                 {"released", &Energies::released},
                                                                 {"gravity", &Energies::gravity},
                                                                 {"loads", &Energies::loads},
                                                                 {"driven", &Energies::driven}};
    const auto part = parts.find(spec.component);
    if (part == parts.end()) refuse(spec, "unknown component '" + spec.component + "' of energy");
    return reading([member = part->second](const Energies& e) { return e.*member; });
}

// ---- all of them ---------------------------------------------------------------------------------------------------

std::string name_of(const ProbeSpec& spec, const Vec2& origin) {
    std::ostringstream name;
    name.precision(10);
    name << spec.quantity;
    if (!spec.component.empty()) name << '.' << spec.component;
    const auto place = [&](const Vec2& p) { name << '(' << p.x() + origin.x() << ", " << p.y() + origin.y() << ')'; };
    if (!spec.block.empty()) name << " of " << spec.block;
    if (spec.point) name << " at ", place(*spec.point);
    if (spec.joint) name << " at joint ", place(*spec.joint);
    return name.str();
}

bool reads_energies(const ProbeSpec& spec) { return spec.quantity == "energy" || spec.quantity == "energy_drift"; }

Reading reading_of(Quantity::Place place, const ProbeSpec& spec, const Model& model, const State& state) {
    switch (place) {
        case Quantity::Place::body:
            return of_motion(spec, model, state);
        case Quantity::Place::joint:
            return of_joint(spec, model, state);
        case Quantity::Place::block:
            return of_support(spec, model, state);
        case Quantity::Place::any:
            if (spec.point || !spec.block.empty()) return of_motion(spec, model, state);
            break;
        case Quantity::Place::scene:
            break;
    }
    return reads_energies(spec) ? of_energy(spec) : of_scene(spec);
}

template <class Memory, class Read>
void remember(Probe& probe, Read read) {
    const auto memory = std::make_shared<Memory>();
    probe.memory = memory;
    probe.read = [memory, read](const Model&, const State& s, const Gauges& g) { return read(*memory, s, g); };
}

}  // namespace

BlockId observed_block(const ProbeSpec& spec, const Model& model, const State& state) {
    return observed_point(spec, model, state).block;
}

Probe make_probe(const ProbeSpec& spec, const Model& model, const State& state) {
    const Quantity* quantity = find_quantity(spec.quantity);
    if (!quantity || !quantity->history) refuse(spec, "is not a quantity that can be observed");
    Probe probe{name_of(spec, model.origin), quantity->unit, reads_energies(spec), {}};
    if (spec.quantity == "slip_changes")
        remember<SlipChanges>(probe, [](SlipChanges& memory, const State& s, const Gauges&) { return memory(s); });
    else if (spec.quantity == "energy_drift")
        remember<EnergyDrift>(probe,
                              [](EnergyDrift& memory, const State& s, const Gauges& g) { return memory(s, g.energies); });
    else
        probe.read = reading_of(quantity->place, spec, model, state);
    return probe;
}

}  // namespace talus
