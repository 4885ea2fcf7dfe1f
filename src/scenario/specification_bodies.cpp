// Rock cut into blocks, and single blocks.
#include "scenario/specification.hpp"

namespace talus::spec {
namespace {

Shape spread(const std::string& unit, Range mean, std::vector<std::string> distributions) {
    return either(
        {number(unit, mean),
         table("spread in " + unit, "A value drawn anew for every joint line; see above for how.",
               {{"mean", number(unit, mean), required, "mean of the distribution"},
                {"deviation", number(unit, not_negative), fallback("0"), "standard deviation"},
                {"distribution", choice(std::move(distributions)), fallback("normal"), "how values lie around the mean"}})});
}

Shape angle() { return spread("deg", {-360, 360}, {"normal", "uniform"}); }
Shape length() { return spread("m", positive, {"normal", "uniform", "lognormal", "exponential"}); }

Shape joint_set() {
    return table(
        "joint set", "Parallel joint lines across the outline.",
        {{"name", text(), derived("set1, set2, ..."), "name in reports and pictures"},
         {"angle_deg", angle(), required, "counter-clockwise from +x"},
         {"spacing", length(), required, "measured across the set"},
         {"persistence", number("1", {0.0, 1.0, true, false}), fallback("1"), "share of a joint line that is cut"},
         {"trace_length", length(), derived("5 times the mean spacing"), "length of the cut pieces when persistence < 1"},
         {"origin", point(), fallback("[0, 0]"), "a point that one joint line passes through"},
         {"seed", integer({0, 9007199254740992.0}), fallback("0"), "of the random numbers of this set"},
         {"joint", text(), derived("as `contacts` says"), "joint on these lines"},
         {"inside", region(), derived("everywhere"), "only inside this outline"}});
}

Shape held() {
    const Shape side = either({boolean(), choice({"roller"})});
    const auto key = [&](const std::string& name) {
        return Key{name, side, fallback("false"), "blocks with an edge along the line of the outline farthest to this side"};
    };
    return table(
        "held", "Blocks of the rock that do not move. `true`: held fully; `roller`: free along the side only.",
        {key("left"),
         key("right"),
         key("bottom"),
         key("top"),
         {"below", number("m"), optional, "y: every block that reaches below this line is held"},
         {"above", number("m"), optional, "y: every block that reaches above this line is held"},
         {"inside", list_of(region()), fallback("[]"), "every block whose centroid lies inside one of them is held"}});
}

Shape crack() {
    return table("crack", "One given polyline.",
                 {{"points", list_of(point(), 2), required, "corners of the polyline"},
                  {"joint", text(), derived("as `contacts` says"), "joint on this line"}});
}

Shape traces() {
    return table(
        "traces", "Mapped traces. Free tips may be extended so that they meet other traces and cut blocks.",
        {{"file", text(), required, "GeoJSON or CSV, relative to the scenario file"},
         {"extend", number("m", not_negative), fallback("0"), "added at the tips of traces that end at no other trace"},
         {"snap", number("m", not_negative), fallback("0"), "corners closer than this become one"},
         {"joint", text(), derived("as `contacts` says"), "joint on the traces"}});
}

Shape named_region() {
    const Shape circle = region().of[1].keys[0].shape;
    return table("region", "Cut out along its outline; other keys name the blocks inside by it.",
                 {{"outline", outline(), optional, "corners"},
                  {"circle", circle, optional, "regular polygon instead of an outline"},
                  {"material", text(), derived("that of the rock"), "of the blocks inside"}},
                 {{Rule::Count::exactly_one, {"outline", "circle"}}});
}

Shape slivers() {
    return table("slivers",
                 "Blocks smaller than this are merged with the neighbour of the longest common edge. When only one "
                 "of the two is given the other is 0.",
                 {{"area", number("m2", not_negative), derived("1e-6 of the mean block area"), "least area"},
                  {"width", number("m", not_negative), derived("1e-3 of the square root of the mean block area"),
                   "least width, twice the area over the perimeter"}});
}

Shape rectangle() {
    return table("rectangle", "",
                 {{"corner", point(), required, "lower left corner, about which it is turned"},
                  {"size", list_of(number("m", positive), 2, 2), required, "`[width, height]`"},
                  {"angle_deg", number("deg", {-360, 360}), fallback("0"), "turned counter-clockwise"}});
}

Shape arch() {
    return table("arch", "A ring of equal voussoirs `name[0]`, `name[1]`, ... with straight edges between the joints.",
                 {{"center", point(), required, "centre of the circle"},
                  {"radius", number("m", positive), required, "of the centre line"},
                  {"thickness", number("m", positive), required, "across the ring, below twice the radius"},
                  {"count", integer({1, 100000}), required, "number of voussoirs"},
                  {"from_deg", number("deg", {-360, 360}), fallback("0"), "where it starts, counter-clockwise from +x"},
                  {"to_deg", number("deg", {-360, 720}), fallback("180"), "where it ends, at most 360 further"}});
}

Shape repeat() {
    const Shape one = table("repetition", "Copies at equal steps, the block itself included.",
                            {{"count", integer({1, 1000000}), required, "number of copies"},
                             {"step", list_of(number("m"), 2, 2), required, "from one copy to the next"},
                             {"stagger", list_of(number("m"), 2, 2), fallback("[0, 0]"),
                              "every second copy is moved by this as well, e.g. for the courses of a wall"}});
    return either({one, list_of(one, 2, 2)});
}

Shape driven() {
    return table("driven",
                 "Prescribed velocity; it goes before `held`, and directions that are neither driven nor held are free.",
                 {{"velocity_x", time_table("m/s"), optional, "along x"},
                  {"velocity_y", time_table("m/s"), optional, "along y"},
                  {"spin", time_table("rad/s"), optional, "counter-clockwise about the centroid"}},
                 {{Rule::Count::at_least_one, {"velocity_x", "velocity_y", "spin"}}});
}

}  // namespace

Shape rock() {
    return table("rock", "A domain cut into blocks along joint sets, cracks, traces and the outlines of regions and holes.",
                 {{"outline", outline(), optional, "of the domain"},
                  {"outline_file", text(), optional, "GeoJSON polygon, relative to the scenario file"},
                  {"material", text(), derived("the only material, if there is one only"), "name of a material"},
                  {"joint_sets", list_of(joint_set()), fallback("[]"), "parallel joint lines"},
                  {"cracks", list_of(crack()), fallback("[]"), "given polylines"},
                  {"traces", traces(), optional, "polylines from a file"},
                  {"holes", list_of(region()), fallback("[]"), "cut and left empty"},
                  {"regions", names_of(named_region()), fallback("{}"),
                   "parts with a name, in this order; where they overlap the "
                   "last one counts"},
                  {"held", held(), fallback("{}"), "which blocks do not move"},
                  {"slivers", slivers(), optional, "which blocks are too small to keep"}},
                 {{Rule::Count::exactly_one, {"outline", "outline_file"}}});
}

Shape block() {
    const Shape fixity = either({boolean(), list_of(boolean(), 3, 3)});
    return table("block", "A block, an arch of blocks, or copies of them.",
                 {{"name", text(), derived("block1, block2, ..."), "copies are called `name[0]`, `name[1]`, ..."},
                  {"outline", outline(), optional, "corners, in any order of rotation; may be concave"},
                  {"rectangle", rectangle(), optional, "instead of an outline"},
                  {"arch", arch(), optional, "instead of an outline"},
                  {"material", text(), derived("the only material, if there is one only"), "name of a material"},
                  {"held", fixity, fallback("false"), "`true`, or `[x, y, rotation]`"},
                  {"driven", driven(), optional, "prescribed velocity"},
                  {"velocity", list_of(number("m/s"), 2, 2), fallback("[0, 0]"), "at the start"},
                  {"spin", number("rad/s"), fallback("0"), "at the start, counter-clockwise"},
                  {"repeat", repeat(), optional, "copies; of two repetitions the copies are called `name[i][j]`"}},
                 {{Rule::Count::exactly_one, {"outline", "rectangle", "arch"}}});
}

}  // namespace talus::spec
