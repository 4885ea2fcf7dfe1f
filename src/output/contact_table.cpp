#include "output/contact_table.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

/// Intact share of the bond of a face, 0..1; 0 for contacts without bond.
double bonded_share(const Model& model, const Contacts& contacts, const Contact& contact) {
    if (contact.face < 0 || !model.faces[contact.face].bonded) return 0.0;
    const auto first = contacts.broken.begin() + model.faces[contact.face].first_cell;
    const int cells = model.joints[model.faces[contact.face].joint].cells;
    return static_cast<double>(std::count(first, first + cells, 0)) / cells;
}

bool ever_bonded(const Model& model, const Contact& contact) {
    return contact.face >= 0 && model.faces[contact.face].bonded;
}

}  // namespace

ContactState contact_state(const Model& model, const Contacts& contacts, const Contact& contact) {
    const bool bond = bonded_share(model, contacts, contact) > 0.0;
    if (!contact.touching && !bond) return ContactState::open;
    if (contact.sliding) return ContactState::sliding;
    if (bond) return ContactState::bonded;
    if (ever_bonded(model, contact)) return ContactState::broken;
    return contact.slipped ? ContactState::slipped : ContactState::elastic;
}

double shear_strength(const Model& model, const Contacts& contacts, const Contact& contact) {
    const Joint& joint = model.joints[contact.joint];
    const bool weak = contact.slipped && joint.weakens;
    const double intact = ever_bonded(model, contact) ? bonded_share(model, contacts, contact) : (weak ? 0.0 : 1.0);
    const double cohesion = intact * joint.cohesion + (1.0 - intact) * joint.cohesion_residual;
    const double friction = weak ? joint.tan_friction_residual : joint.tan_friction;
    return cohesion * contact.length + std::max(contact.normal_force, 0.0) * friction;
}

ContactTable contact_table(const Model& model, const State& state) {
    ContactTable table;
    for (const Contact& c : state.contacts.list) {
        if (!c.alive) continue;
        const double strength = shear_strength(model, state.contacts, c), shear = std::abs(c.shear_force);
        const double per_length = c.length > 0.0 ? 1.0 / c.length : 0.0;
        table.block_a.push_back(model.parts.block[c.part_a]);
        table.block_b.push_back(model.parts.block[c.part_b]);
        table.part_a.push_back(c.part_a);
        table.part_b.push_back(c.part_b);
        table.joint.push_back(c.joint);
        table.x.push_back(static_cast<float>(c.point.x()));
        table.y.push_back(static_cast<float>(c.point.y()));
        table.nx.push_back(static_cast<float>(c.normal.x()));
        table.ny.push_back(static_cast<float>(c.normal.y()));
        table.normal_force.push_back(static_cast<float>(c.normal_force));
        table.shear_force.push_back(static_cast<float>(c.shear_force));
        table.normal_stress.push_back(static_cast<float>(c.normal_force * per_length));
        table.shear_stress.push_back(static_cast<float>(c.shear_force * per_length));
        table.opening.push_back(static_cast<float>(-c.overlap));
        table.slip.push_back(static_cast<float>(c.slip));
        table.length.push_back(static_cast<float>(c.length));
        table.utilisation.push_back(static_cast<float>(strength > 0.0 ? shear / strength : (shear > 0.0 ? 1.0 : 0.0)));
        table.state.push_back(static_cast<std::uint8_t>(contact_state(model, state.contacts, c)));
    }
    return table;
}

}  // namespace talus
