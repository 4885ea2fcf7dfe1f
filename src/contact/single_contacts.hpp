// Contacts one at a time: corners, bonds, and what changes its kind. Any contact may go this way; the batches of
// update_contacts.cpp are the same for those that are many.
#pragma once

#include "contact/contacts.hpp"
#include "contact/corner_pair.hpp"
#include "contact/face_path.hpp"
#include "contact/response.hpp"
#include "contact/separation.hpp"

#include <optional>

namespace talus {

struct ContactWork {  // J
    double friction = 0.0, damping = 0.0, released = 0.0;
};

/// The two sides of one contact.
struct Couple {
    PlacedPart a, b;
    BlockId block_a, block_b;
    double dx, dy;  // m, from the centroid of a to that of b
};
inline Couple couple(const Model& model, const Placed& placed, const Contact& c) {
    const BlockId a = model.parts.block[c.part_a], b = model.parts.block[c.part_b];
    const Vec2 &from = placed.block[a].position, &to = placed.block[b].position;
    return {{model, placed, c.part_a}, {model, placed, c.part_b}, a, b, to.x() - from.x(), to.y() - from.y()};
}

CornerLines corner_lines(const Placed& placed, const CornerSlot& slot, double dx, double dy);

class SingleContacts {
public:
    ContactWork work;
    bool changed = false;  // set when the contact is perhaps of another kind now, or has begun or ended

    SingleContacts(const Model& model, const Placed& placed, double dt, Contacts& contacts)
        : model_(model),
          placed_(placed),
          dt_(dt),
          damping_(dt > 0.0 ? model.contact_damping : 0.0),
          contacts_(contacts),
          list_(contacts.list.behind()) {}

    /// Geometry and law of one contact of the list.
    void evaluate(int i);
    /// One that carries nothing any more, as its faces say.
    void unload(int i);
    /// The faces have turned away or slid off: bonds and initial stress are over, for good.
    void end_face(int i);
    /// The two corners of a contact that carries force without faces; none if it is not that simple.
    std::optional<CornerSlot> corners(int i) const;

private:
    Approach approach(const Couple& s) const;
    Pressed press(Contact& c, const Couple& s, Separation& apart);
    FaceContact remembered_face(Contact& c, const Couple& s);
    void load(int i, const Couple& s, const Pressed& p);
    void part(int i, const Couple& s, const Separation& apart);
    void end_face(Contact& c, const Couple& s);
    void break_bonds(const Contact& c, const Couple& s);
    double bond_energy(const Contact& c, const Couple& s) const;
    double face_length(const Contact& c) const;

    const Model& model_;
    const Placed& placed_;
    double dt_, damping_;
    Contacts& contacts_;
    std::vector<Contact>& list_;
};

}  // namespace talus
