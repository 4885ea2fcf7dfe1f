// The contacts of one moment as the columns people read: forces, joint stresses, opening, utilisation, state.
#pragma once

#include "model/model.hpp"
#include "model/state.hpp"

#include <cstdint>
#include <vector>

namespace talus {

enum class ContactState : std::uint8_t { elastic = 0, sliding = 1, slipped = 2, bonded = 3, broken = 4, open = 5 };

/// What the joint is doing now comes before what it did: open without bond, sliding, bond (partly) intact, bond broken,
/// slipped before, never slipped.
ContactState contact_state(const Model& model, const Contacts& contacts, const Contact& contact);

struct ContactTable {                                                   // n contacts that are alive, in key order
    std::vector<std::int32_t> block_a, block_b, part_a, part_b, joint;  // [n]
    std::vector<float> x, y, nx, ny;                 // [n] m, relative to the origin of the scene; unit normal from a to b
    std::vector<float> normal_force, shear_force;    // [n] N per m, compression > 0; along perp(normal) on b
    std::vector<float> normal_stress, shear_stress;  // [n] Pa, force / length
    std::vector<float> opening, slip, length;        // [n] m
    std::vector<float> utilisation;                  // [n] |shear force| / shear strength, as the law left it
    std::vector<std::uint8_t> state;                 // [n] ContactState
    std::int64_t size() const { return static_cast<std::int64_t>(joint.size()); }
};

ContactTable contact_table(const Model& model, const State& state);

/// Calls visit(name, unit, column) for every column, so that names and units stand in one place.
template <class Table, class Visit>
void for_each_column(Table& table, Visit&& visit) {
    visit("block_a", "1", table.block_a);
    visit("block_b", "1", table.block_b);
    visit("part_a", "1", table.part_a);
    visit("part_b", "1", table.part_b);
    visit("joint", "1", table.joint);
    visit("x", "m", table.x);
    visit("y", "m", table.y);
    visit("nx", "1", table.nx);
    visit("ny", "1", table.ny);
    visit("normal_force", "N", table.normal_force);
    visit("shear_force", "N", table.shear_force);
    visit("normal_stress", "Pa", table.normal_stress);
    visit("shear_stress", "Pa", table.shear_stress);
    visit("opening", "m", table.opening);
    visit("slip", "m", table.slip);
    visit("length", "m", table.length);
    visit("utilisation", "1", table.utilisation);
    visit("state", "1", table.state);
}

}  // namespace talus
