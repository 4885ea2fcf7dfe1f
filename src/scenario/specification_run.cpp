// Stages, run, record, expect.
#include "scenario/quantities.hpp"
#include "scenario/specification.hpp"

#include <set>

namespace talus::spec {
namespace {

Shape until() {
    return table(
        "until", "When a stage ends: at the time or in equilibrium, whichever comes first.",
        {{"time", number("s", positive), optional, "length of the stage"},
         {"equilibrium", number("1", positive), optional, "ends when the unbalanced ratio stays below this"},
         {"iterations", integer({1, 1000000000}), optional,
          "of a static stage at most, 100000 if not given; a `time` ends none"},
         {"verdict", boolean(), optional,
          "of `run`: ends as soon as it is certain whether the blocks stand; `time` is then the most that is computed"}},
        {{Rule::Count::at_least_one, {"time", "equilibrium"}}});
}

Shape damping() {
    return table(
        "damping", "None unless given.",
        {{"local", number("1", {0.0, 1.0, false, true}), fallback("0"),
          "share of the out-of-balance force that opposes the motion"},
         {"contact", number("s", not_negative), fallback("0"), "contact force = this x stiffness x relative velocity"}});
}

Shape time_step() { return either({choice({"auto"}), number("s", positive)}); }

Shape solver() { return choice({"auto", "explicit", "rigid", "static"}); }

Shape accuracy() {
    const Shape share = number("1", {0.0, 0.5, true, true});
    return either({share, table("accuracy",
                                "The error that is accepted. Talus chooses what the scenario leaves open, and `talus check` "
                                "says what and why. A number is the `motion`.",
                                {{"motion", share, optional,
                                  "of the motion of blocks whose joints do not give, or of the size of a block where blocks "
                                  "hardly move; what joints close counts as error"},
                                 {"joint_stress", share, optional,
                                  "of what joints of the stiffness given carry; what they close is part of the answer"}},
                                {{Rule::Count::at_least_one, {"motion", "joint_stress"}}})});
}

Shape change() {
    return table("change", "New values that hold from the start of the stage to the end of the run.",
                 {{"joints", names_of(joint_change()), fallback("{}"), "joints by name, with the keys that change"}});
}

std::vector<std::string> names_of_quantities(bool history_only) {
    std::vector<std::string> names;
    for (const Quantity& quantity : quantities())
        if (quantity.history || !history_only) names.push_back(quantity.name);
    return names;
}

Shape components() {
    std::vector<std::string> all;
    std::set<std::string> seen;
    for (const Quantity& quantity : quantities())
        for (const std::string& component : quantity.components)
            if (seen.insert(component).second) all.push_back(component);
    return titled("component", "Which part of a quantity; the table of quantities says which of them it has.", choice(all));
}

Shape observable() {
    return titled("observable", "A quantity that can be recorded; see the table of quantities.",
                  choice(names_of_quantities(true)));
}

Shape verdicts() {
    return choice({"stable", "unstable", "undecided", "none", "slide", "topple", "slide and topple", "fall", "rotation"});
}

std::vector<Key> place() {
    return {{"point", point(), optional, "the block that contains it when the run starts, at this point"},
            {"joint", point(), optional, "the joint nearest to this place when the run starts"},
            {"block", text(), optional, "name of a block"}};
}

std::vector<Key> direction() {
    return {{"component", components(), derived("see the table of quantities"), "of a quantity that has components"},
            {"direction_deg", number("deg", {-360, 360}), optional, "of component `along`, counter-clockwise from +x"}};
}

std::vector<Key> joined(std::vector<std::vector<Key>> groups) {
    std::vector<Key> all;
    for (auto& group : groups) all.insert(all.end(), group.begin(), group.end());
    return all;
}

}  // namespace

Shape stage() {
    return table(
        "stage", "What happens before `run`. Changed joints and deleted blocks stay; all else holds in this stage only.",
        {{"name", text(), derived("stage1, stage2, ..."), "name in reports"},
         {"solver", solver(), derived("that of `run`"), "how motion is integrated in this stage, or equilibrium is found"},
         {"settle", boolean(), fallback("false"),
          "fills in `until.equilibrium` 1e-6, `reset` true and, with a solver for motion, `damping.local` 0.8, unless they "
          "are given"},
         {"reset", boolean(), fallback("false"), "afterwards clock, velocities and displacements are zero"},
         {"delete", list_of(selector()), fallback("[]"), "blocks taken out at the start of the stage"},
         {"release", number("s", not_negative), fallback("0"), "time over which the forces of deleted blocks fade away"},
         {"change", change(), fallback("{}"), "properties that change"},
         {"gravity", vector_table("m/s2"), derived("that of the scenario"), "times count from the start of the stage"},
         {"loads", list_of(load()), derived("those of the scenario"),
          "instead of them; times count from the start of the stage"},
         {"until", until(), derived("in equilibrium if `settle`"), "when the stage ends; must be given unless `settle`"},
         {"damping", damping(), fallback("{}"), "of this stage"},
         {"time_step", time_step(), fallback("auto"), "of this stage"}});
}

Shape run() {
    return table(
        "run", "The last stage, and how to compute. `search`, `skin` and `threads` never change a result.",
        {{"until", until(), optional,
          "when the run ends; must be given unless there are stages, of which the last is then the end"},
         {"accuracy", accuracy(), optional, "the error that is accepted; decides what the scenario leaves open"},
         {"solver", solver(), fallback("auto"),
          "how motion is integrated, or equilibrium is found; `auto` is `explicit` unless `accuracy` decides"},
         {"time_step", time_step(), fallback("auto"), "automatic: a share of the rigorous bound"},
         {"step_fraction", number("1", positive), derived("0.8, or by `accuracy`"),
          "share of the rigorous bound in an automatic step"},
         {"unchecked", boolean(), fallback("false"),
          "accept a time step above the stable estimate, and joints so soft that blocks pass through each other"},
         {"damping", damping(), fallback("{}"), "of the run"},
         {"smallest_failure", number("1", {0.0, 1.0, false, true}), optional,
          "of the verdict: share of the area of all free blocks that makes the scene unstable when it is on its way; less "
          "of it "
          "is loose stones, which are counted. 0.001 if not given; 0: every chip counts"},
         {"freeze", either({choice({"never"}), number("1", {0.0, 0.1, true, false})}), derived("never, or by `accuracy`"),
          "a block at rest is not computed while less than this share of what its contacts hand on, or of its weight if "
          "that is more, is out of balance"},
         {"substeps", either({choice({"auto"}), integer({1, 8})}), fallback("1"),
          "1, 2, 4 or 8 steps of blocks whose stable step is short in one step of the others; `auto`: as many as save most, "
          "if that is a fifth; explicit solver only"},
         {"search",
          choice({"auto", "safe-regions", "verlet", "isu", "isu-separated", "isu-parallel", "dess", "dess-fused", "direct",
                  "direct-simd", "grid"}),
          fallback("auto"), "how neighbours are found"},
         {"skin", either({choice({"auto"}), number("m", not_negative)}), fallback("auto"),
          "how far a block moves before neighbours are searched again"},
         {"face_path", boolean(), fallback("true"), "closed form for faces; false: the general form everywhere"},
         {"rounding_length", number("m", positive), optional,
          "the classical geometry for comparison: corners rounded from this far, pressed as point springs; a hundredth of "
          "an edge, say"},
         {"threads", integer({1, 1024}), fallback("1"), "number of threads"}});
}

Shape record() {
    const Shape frames = table("frames", "Pictures of the whole state.",
                               {{"every", number("s", positive), optional, "time between two of them"},
                                {"count", integer({1, 1000000}), derived("50"), "how many after the first one"}},
                               {{Rule::Count::at_most_one, {"every", "count"}}});
    const Shape history = table(
        "history",
        "Numbers recorded along the run. Quantities that have components are recorded with x and y unless "
        "`component` is given.",
        joined({{{"name", text(), derived("history1, history2, ..."), "name in the results"}},
                place(),
                {{"quantity", observable(), derived("see above"), "one quantity"},
                 {"quantities", list_of(observable(), 1), derived("see above"), "several of them"}},
                direction(),
                {{"every", number("s", positive), derived("every step"), "time between two values"}}}),
        {{Rule::Count::at_most_one, {"point", "joint", "block"}}, {Rule::Count::at_most_one, {"quantity", "quantities"}}});
    return table("record", "What goes into the results file.",
                 {{"frames", frames, fallback("{}"), "pictures of the whole state"},
                  {"history", list_of(history), fallback("[]"), "numbers along the run"},
                  {"contacts", boolean(), fallback("true"), "write the contacts of every frame"}});
}

Shape expectation() {
    return table(
        "expectation",
        "One number that must come out. Of `value` and `same_as` (with a tolerance), `above` and `below` exactly one is "
        "given, and none for `stable`, `unstable`, `verdict`, `mechanism`, `fault` and `warning`.",
        joined({{{"quantity", choice(names_of_quantities(false)), required, "see the table of quantities"}},
                direction(),
                place(),
                {{"of", observable(), derived("displacement; of loop_area: shear_stress"),
                  "what frequency, decrement and loop_area look at"},
                 {"against", observable(), derived("shear_displacement"), "second axis of loop_area"},
                 {"at", either({choice({"end", "max", "min"}), number("s", not_negative)}), derived("end"),
                  "a time since the last reset, or the largest or smallest value of the run"},
                 {"between", list_of(number("s", not_negative), 2, 2), optional,
                  "`[t1, t2]`: two times since the last reset; must be given for acceleration"},
                 {"value", number(), optional, "expected value, in the unit of the quantity"},
                 {"same_as", text(), optional,
                  "name of an earlier case: the value is what the expectation at the same place of its list measured"},
                 {"tolerance", number("1", not_negative), optional, "allowed deviation relative to |value|"},
                 {"tolerance_absolute", number("", not_negative), optional,
                  "allowed deviation in the unit of the quantity; of two tolerances the larger counts"},
                 {"above", number(), optional, "lower bound"},
                 {"below", number(), optional, "upper bound"},
                 {"limit", number("m", positive), derived("1e-3 of the size of the block"), "of stable and unstable"},
                 {"is", either({verdicts(), list_of(verdicts(), 1)}), optional,
                  "of verdict and mechanism, which need it: the one that is expected, or a list of those that will do"},
                 {"says", text(), optional, "of fault and warning, which need it: words that must stand in the text"}}}),
        {{Rule::Count::at_most_one, {"value", "same_as", "above", "below"}},
         {Rule::Count::at_most_one, {"point", "joint", "block"}}});
}

}  // namespace talus::spec
