#include "scenario/quantities.hpp"

namespace talus {

const std::vector<Quantity>& quantities() {
    using enum Quantity::Place;
    using Words = std::vector<std::string>;
    static const Words vector = {"x", "y", "magnitude", "along"}, axis = {"x", "y", "along"};
    static const Words energies = {"total",        "kinetic",  "strain",          "strain_normal",
                                   "strain_shear", "friction", "contact_damping", "local_damping",
                                   "released",     "gravity",  "loads",           "driven"};
    static const std::vector<Quantity> all = {
        {"displacement", "m", body, vector, "magnitude", true, "since the start or the last reset"},
        {"velocity", "m/s", body, vector, "magnitude", true, "of the point, or of the centroid of the block"},
        {"position", "m", body, axis, "", true, "in the coordinates of the file"},
        {"rotation", "rad", body, {}, "", true, "of the block since the start or the last reset, counter-clockwise"},
        {"spin", "rad/s", body, {}, "", true, "angular velocity, counter-clockwise"},
        {"acceleration", "m/s2", body, vector, "magnitude", false,
         "change of velocity over `between`, divided by its length"},
        {"frequency", "Hz", body, axis, "", false, "of the oscillation of `of`, from its maxima"},
        {"decrement", "1", body, axis, "", false, "mean logarithm of the ratio of successive peaks of `of`"},
        {"normal_force", "N", joint, {}, "", true, "compression positive"},
        {"shear_force",
         "N",
         joint,
         {},
         "",
         true,
         "along the joint, on the block of the higher number, along the normal "
         "turned by +90 degrees"},
        {"normal_stress", "Pa", joint, {}, "", true, "normal force divided by the contact length"},
        {"max_normal_stress", "Pa", joint, {}, "", true, "largest normal stress along the joint face"},
        {"shear_stress", "Pa", joint, {}, "", true, "shear force divided by the contact length"},
        {"slip", "m", joint, {}, "", true, "plastic shear displacement, without its elastic part"},
        {"shear_displacement", "m", joint, {}, "", true, "relative movement along the joint, elastic part and slip"},
        {"opening", "m", joint, {}, "", true, "gap across the joint; negative when pressed together"},
        {"contact_length", "m", joint, {}, "", true, "length over which the two blocks press on each other"},
        {"utilisation", "1", joint, {}, "", true, "shear force divided by the shear strength; 1 = slipping"},
        {"loop_area", "J/m2", joint, {}, "", false, "area that `of` encloses over `against` in its last full cycle"},
        {"reaction", "N", block, vector, "magnitude", true, "sum of the contact forces on the block"},
        {"moment", "N m", block, {}, "", true, "moment of the contact forces on the block about its centroid"},
        {"energy", "J", scene, energies, "total", true, "stored now, or dissipated or worked since the last reset"},
        {"energy_drift",
         "1",
         scene,
         {},
         "",
         true,
         "change of the total energy since the last reset, relative to the largest energy that moved"},
        {"energy_gain",
         "1",
         scene,
         {},
         "",
         true,
         "largest energy that came from nowhere, relative to the largest energy of the run; looked at every 100 steps"},
        {"momentum", "kg m/s", scene, vector, "magnitude", true, "of all free blocks"},
        {"angular_momentum", "kg m2/s", scene, {}, "", true, "of all free blocks, about the origin"},
        {"max_speed", "m/s", scene, {}, "", true, "of the fastest corner"},
        {"max_displacement", "m", scene, {}, "", true, "of the centroid of the free block that moved farthest"},
        {"max_overlap",
         "m",
         scene,
         {},
         "",
         true,
         "largest mean overlap of two faces or of a corner; parts that stand open count as negative"},
        {"slip_changes",
         "1",
         scene,
         {},
         "",
         true,
         "how often contacts have begun or ceased to slide since the last reset, from one recorded time to the next"},
        {"area", "m2", any, {}, "", true, "of the block; without a place: of all blocks"},
        {"relative_displacement",
         "1",
         any,
         {},
         "",
         true,
         "displacement divided by the size of the block, the square root of its area; without a place: the largest of all "
         "free blocks"},
        {"unbalanced", "1", scene, {}, "", true, "largest out-of-balance force over the mean contact force of a block"},
        {"time_step", "s", scene, {}, "", true, "the step in use"},
        {"stable_step", "s", scene, {}, "", true, "estimate of the largest stable step"},
        {"equilibrium", "1", scene, {}, "", true, "1 = the last static stage came to equilibrium; 0 = it did not"},
        {"stable", "", any, {}, "", false, "the displacement never exceeds `limit`; without a place: of every free block"},
        {"unstable", "", any, {}, "", false, "the displacement exceeds `limit`; without a place: of some free block"},
        {"verdict",
         "",
         scene,
         {},
         "",
         false,
         "what `is` says: whether the blocks stand, as told at the end of the run: stable, unstable or undecided"},
        {"mechanism",
         "",
         any,
         {},
         "",
         false,
         "what `is` says: where a block goes; without a place: most of what moves. One of none, slide, topple, slide and "
         "topple, fall, rotation"},
        {"fault",
         "",
         scene,
         {},
         "",
         false,
         "the scene is refused, or the run ends early, and the report has what `says` says"},
        {"warning", "", scene, {}, "", false, "there is a warning that has what `says` says"},
    };
    return all;
}

const Quantity* find_quantity(const std::string& name) {
    for (const Quantity& quantity : quantities())
        if (quantity.name == name) return &quantity;
    return nullptr;
}

std::string place_text(Quantity::Place place) {
    switch (place) {
        case Quantity::Place::body:
            return "point or block";
        case Quantity::Place::block:
            return "block or point";
        case Quantity::Place::joint:
            return "joint";
        case Quantity::Place::scene:
            break;
        case Quantity::Place::any:
            return "point, block or none";
    }
    return "none";
}

}  // namespace talus
