#include "simulation/preview.hpp"

#include "geometry/polygon.hpp"
#include "model/neighbours.hpp"

namespace talus {

State with_all_touching_faces(const Simulation& simulation) {
    const Model& model = simulation.model();
    std::vector<Vec2> corner;
    for (PartId p = 0; p < model.parts.size(); ++p)
        for (int k = model.parts.first_corner[p]; k < model.parts.first_corner[p + 1]; ++k)
            corner.push_back(model.blocks.start[model.parts.block[p]] + model.corners.arm[k]);
    const Box all = bounds(corner);
    const double tolerance = 1e-9 * std::max(all.xmax - all.xmin, all.ymax - all.ymin) + 4.0 * rounding(corner);

    State state = simulation.first_state();
    for (const Neighbours::Touch& touch : find_neighbours(model, corner, tolerance).touches) {
        Contact contact{
            .part_a = touch.part_a, .part_b = touch.part_b, .joint = model.joint_between(touch.part_a, touch.part_b)};
        contact.touching = contact.alive = 1;
        contact.length = touch.s1 - touch.s0;
        contact.normal = model.corners.normal[touch.edge_a];
        contact.point = corner[touch.edge_a] + 0.5 * (touch.s0 + touch.s1) * perp(contact.normal);
        state.contacts.list.push_back(contact);
    }
    state.contacts.reaction.resize(state.contacts.list.size());
    return state;
}

}  // namespace talus
