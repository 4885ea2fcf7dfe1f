#include "output/contact_table.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

bool ever_bonded(const Model& model, const Contact& contact) {
    return contact.face >= 0 && model.faces[contact.face].bonded;
}

bool bonded(const Model& model, const Contacts& contacts, const Contact& contact) {
    if (!ever_bonded(model, contact)) return false;
    const JointFace& face = model.faces[contact.face];
    const auto first = contacts.broken.begin() + face.first_cell;
    return std::count(first, first + model.joints[face.joint].cells, 0) > 0;
}

}  // namespace

ContactState contact_state(const Model& model, const Contacts& contacts, const Contact& contact) {
    const bool bond = bonded(model, contacts, contact);
    if (!contact.touching && !bond) return ContactState::open;
    if (contact.sliding) return ContactState::sliding;
    if (bond) return ContactState::bonded;
    if (ever_bonded(model, contact)) return ContactState::broken;
    return contact.slipped ? ContactState::slipped : ContactState::elastic;
}

ContactTable contact_table(const Model& model, const State& state) {
    ContactTable table;
    for (const Contact& c : state.contacts.list) {
        if (!c.alive) continue;
        const double shear = std::abs(c.shear_force);
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
        table.utilisation.push_back(static_cast<float>(c.strength > 0.0 ? shear / c.strength : 0.0));
        table.state.push_back(static_cast<std::uint8_t>(contact_state(model, state.contacts, c)));
    }
    return table;
}

}  // namespace talus
