// Names of the energies in files, in one place.
#pragma once

#include "model/measure.hpp"

namespace talus {

/// Calls visit(name, J) for every member of Energies and for the total.
template <class Visit>
void for_each_energy(const Energies& e, Visit&& visit) {
    const auto& [kinetic, strain_normal, strain_shear, friction, contact_damping, local_damping, released, gravity, loads,
                 driven] = e;  // a new member must be named here
    visit("kinetic", kinetic);
    visit("strain_normal", strain_normal);
    visit("strain_shear", strain_shear);
    visit("friction", friction);
    visit("contact_damping", contact_damping);
    visit("local_damping", local_damping);
    visit("released", released);
    visit("gravity", gravity);
    visit("loads", loads);
    visit("driven", driven);
    visit("total", e.total());
}

}  // namespace talus
