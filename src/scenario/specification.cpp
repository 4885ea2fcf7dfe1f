// The scenario as a whole, materials and joints, loads and initial stress. Rock and blocks: specification_bodies.cpp;
// stages, run, record, expect: specification_run.cpp.
#include "scenario/specification.hpp"

namespace talus::spec {

Shape point() { return titled("point", "`[x, y]` in m.", list_of(number("m"), 2, 2)); }

Shape outline() {
    return titled("outline",
                  "Corners of a simple polygon. The last corner is joined to the first, which may be repeated at the end; "
                  "clockwise corners are turned round.",
                  list_of(point(), 3));
}

Shape region() {
    const Shape circle =
        table("circle", "A regular polygon in place of an outline, with its corners on the circle.",
              {{"center", point(), required, "centre of the circle"},
               {"radius", number("m", positive), required, "radius of the circle"},
               {"sides", integer({3, 1000}), fallback("32"), "number of corners; the first one lies at +x"}});
    return either(
        {outline(), table("round outline", "", {{"circle", circle, required, "regular polygon in place of corners"}})});
}

Shape time_table(const std::string& unit) {
    return either(
        {number(unit), table("time table of a number",
                             "A number that changes in time: linear between the given times, constant outside them.",
                             {{"time", list_of(number("s"), 1), required, "increasing times"},
                              {"value", list_of(number(), 1), required, "as many values, in the unit of the key"}})});
}

Shape vector_table(const std::string& unit) {
    return either({list_of(number(unit), 2, 2),
                   table("time table of a vector",
                         "A vector that changes in time: linear between the given times, constant outside them.",
                         {{"time", list_of(number("s"), 1), required, "increasing times"},
                          {"x", list_of(number(), 1), required, "as many values, in the unit of the key"},
                          {"y", list_of(number(), 1), required, "as many values, in the unit of the key"}})});
}

Shape selector() {
    const Shape one = table("blocks by", "Names blocks in one of four ways.",
                            {{"block", text(), optional, "a block, or all copies of a repeated one"},
                             {"region", text(), optional, "blocks inside a region of the rock"},
                             {"at", point(), optional, "the block that contains this point when the run starts"},
                             {"inside", region(), optional, "blocks whose centroid lies inside when the run starts"}},
                            {{Rule::Count::exactly_one, {"block", "region", "at", "inside"}}});
    return titled("selector", "Names blocks: the name of a block or region, a point inside a block, or a table.",
                  either({text(), point(), one}));
}

Shape load() {
    return table("load", "A force or moment on a block; on every one of them if the selector names several.",
                 {{"block", selector(), required, "what it acts on"},
                  {"force", vector_table("N"), fallback("[0, 0]"), "per m of thickness; does not turn with the block"},
                  {"moment", time_table("N m"), fallback("0"), "counter-clockwise"},
                  {"point", point(), derived("the centroid"), "where the force acts; it moves with the block"}},
                 {{Rule::Count::at_least_one, {"force", "moment"}}});
}

namespace {

constexpr Range friction_range{0.0, 90.0, false, true};

const std::string joint_meaning =
    "Mohr-Coulomb joint with springs in normal and shear direction per unit of contact length, peak and residual strength. "
    "`contacts` says where it acts.";

// A stage that changes a joint gives some keys only: there nothing is required and nothing filled in.
Shape joint_keys(const std::string& title, const std::string& meaning, bool change) {
    const auto must = change ? optional : derived("by `run.accuracy`; without one it must be given");
    const auto zero = change ? optional : fallback("0");
    const Shape residual = table(
        change ? "residual change" : "residual",
        "Strength after the first slip, or after the last bond cell broke; never above the peak. Tension is then none.",
        {{"friction_angle_deg", number("deg", friction_range), change ? optional : derived("the peak value"),
          "friction angle"},
         {"cohesion", number("Pa", not_negative), zero, "cohesion"}});
    std::vector<Key> keys{
        {"normal_stiffness", number("Pa/m", positive), must, "stress per closure"},
        {"shear_stiffness", number("Pa/m", positive), must, "stress per elastic shear displacement"},
        {"friction_angle_deg", number("deg", friction_range), zero, "peak friction angle"},
        {"cohesion", number("Pa", not_negative), zero, "of the unbroken bond"},
        {"tension", number("Pa", not_negative), zero, "tensile strength of the unbroken bond"},
        {"dilation_angle_deg", number("deg", friction_range), zero, "not above the friction angle, nor the residual one"},
        {"dilation_cutoff_slip", number("m", positive), change ? optional : derived("no cut-off"),
         "no dilation beyond this slip"},
        {"restitution", number("1", {0.0, 1.0, false, false}), change ? optional : derived("0 for the rigid solver"),
         "share of the speed of approach with which blocks rebound; for the rigid solver only, which `run.accuracy` then "
         "chooses"},
        {"residual", residual, change ? optional : derived("as peak"), "strength after the first slip or break"}};
    // Not in a change: the cells of the faces are counted when the scene is built.
    if (!change)
        keys.push_back({"cells", integer({1, 1000}), fallback("2"), "pieces of a bonded face that break one by one"});
    return table(title, meaning, std::move(keys));
}

Shape contacts() {
    const Shape pair = table("pair", "Two names and the joint that acts between them.",
                             {{"a", text(), required, "one side"},
                              {"b", text(), required, "other side; may be the same name"},
                              {"joint", text(), required, "name of a joint"}});
    return table("contacts", "Which joint acts where; the order of precedence is given above.",
                 {{"default", text(), derived("the only joint, if there is one only"), "where nothing else is said"},
                  {"materials", list_of(pair), fallback("[]"), "by the materials of the two blocks"},
                  {"blocks", list_of(pair), fallback("[]"), "by name of block, of repeated blocks or of region"}});
}

Shape initial_stress() {
    const Shape on_joint = table("stress on a joint", "Initial stress on every face of one joint; goes before the field.",
                                 {{"joint", text(), required, "name of a joint"},
                                  {"normal", number("Pa"), fallback("0"), "compression positive"},
                                  {"shear", number("Pa"), fallback("0"), "as `shear_stress` in the table of quantities"}});
    const Shape stress = list_of(number("Pa"), 3, 3), gradient = list_of(number("Pa/m"), 3, 3);
    const auto side = [](const std::string& name) {
        return Key{name, boolean(), fallback("false"),
                   "free edges on this side carry the stress of the field as a dead load"};
    };
    return table(
        "initial stress",
        "Stress in the joints before anything moves, compression positive: an in-situ field (`k0`), or a given field "
        "`stress + x gradient_x + y gradient_y`, or joint by joint.",
        {{"k0", number("1", not_negative), optional, "horizontal over vertical stress"},
         {"surface", number("m"), derived("top of the scene"), "y where the vertical stress is the surcharge"},
         {"surcharge", number("Pa"), fallback("0"), "vertical stress at the surface"},
         {"unit_weight", number("N/m3", not_negative), derived("density of `rock.material` times gravity at the start"),
          "increase of the vertical stress with depth"},
         {"stress", stress, optional, "`[xx, yy, xy]` at the point (0, 0) of the file's coordinates"},
         {"gradient_x", gradient, fallback("[0, 0, 0]"), "increase of `[xx, yy, xy]` per m along x"},
         {"gradient_y", gradient, fallback("[0, 0, 0]"), "increase of `[xx, yy, xy]` per m along y"},
         {"joints", list_of(on_joint), fallback("[]"), "joint by joint"},
         side("left"),
         side("right"),
         side("bottom"),
         side("top")},
        {{Rule::Count::at_most_one, {"k0", "stress"}}, {Rule::Count::at_least_one, {"k0", "stress", "joints"}}});
}

Shape cases() {
    return table(
        "case", "One row of a verification table: the scenario with some keys changed.",
        {{"name", text(), derived("case1, case2, ..."), "name in the report"},
         {"set", names_of(anything()), fallback("{}"),
          "`path: value`, e.g. `joints.base.friction_angle_deg: 20` or `blocks[0].velocity: [1, 0]`; in braces a path "
          "with `[0]` needs quotes"},
         {"expect", list_of(expectation()), derived("that of the scenario"), "replaces the whole list"}});
}

Shape whole() {
    const Shape material =
        table("material", "What blocks are made of.", {{"density", number("kg/m3", positive), required, "mass per volume"}},
              {}, {"young", "poisson", "thermal_expansion"});
    return table(
        "scenario", "The whole file. One of `rock` and `blocks` must be there, and `run.until` or `stages`.",
        {{"title", text(), fallback("\"\""), "one line for people"},
         {"source", text(), fallback("\"\""), "where the case and its expected values come from"},
         {"origin", either({choice({"auto"}), point()}), fallback("auto"),
          "subtracted from every coordinate while computing"},
         {"gravity", vector_table("m/s2"), fallback("[0, 0]"), "none unless given, e.g. `[0, -9.81]`"},
         {"body_acceleration", vector_table("m/s2"), fallback("[0, 0]"), "added to gravity, e.g. shaking of the ground"},
         {"materials", names_of(material), fallback("{}"), "materials by name"},
         {"joints", names_of(joint()), fallback("{}"), "joints by name"},
         {"contacts", contacts(), fallback("{}"), "which joint acts where"},
         {"rock", rock(), optional, "a domain cut into blocks"},
         {"blocks", list_of(block()), optional, "single blocks, arches and repeated blocks"},
         {"loads", list_of(load()), fallback("[]"), "forces on blocks, from the start"},
         {"initial_stress", initial_stress(), optional, "stress in the joints before anything moves"},
         {"stages", list_of(stage()), fallback("[]"), "what happens before `run`, in this order"},
         {"run", run(), fallback("{}"), "the last stage, and how to compute"},
         {"record", record(), fallback("{}"), "what goes into the results file"},
         {"expect", list_of(expectation()), fallback("[]"), "what must come out"},
         {"cases", list_of(cases()), optional, "variants of the scenario, each with its own expectations"}},
        {{Rule::Count::at_least_one, {"rock", "blocks"}}},
        {"water", "bolts", "deformation", "strength_reduction", "joint_flow", "base_motion"});
}

}  // namespace

Shape joint() { return joint_keys("joint", joint_meaning, false); }
Shape joint_change() { return joint_keys("joint change", "Keys of a joint that get a new value; the others stay.", true); }

const Shape& scenario() {
    static const Shape all = whole();
    return all;
}

const Shape& scenario_without_accuracy() {
    static const Shape all = [] {
        Shape strict = whole();
        for (Key& key : strict.keys)
            for (Key& of_joint : key.name == "joints" ? key.shape.of.front().keys : key.shape.keys)
                if (of_joint.name.ends_with("_stiffness")) of_joint.presence = required;
        return strict;
    }();
    return all;
}

}  // namespace talus::spec
