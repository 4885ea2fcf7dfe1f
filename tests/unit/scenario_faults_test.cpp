// Bad input: every fault in one report, with line, key and the nearest right word.
#include "scenario/reader.hpp"
#include "support/catch.hpp"
#include "unit/scenario_text.hpp"

#include <filesystem>
#include <fstream>

using namespace talus;
using test::full_scenario;
using test::small_scenario;

namespace {

/// Texts of all faults; empty if the scenario is accepted.
std::vector<std::string> faults_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
    try {
        read_cases_text(text, "f.yaml", "", overrides);
    } catch (const InputError& error) {
        std::vector<std::string> all;
        for (const Fault& fault : error.faults()) all.push_back(fault.text());
        return all;
    }
    return {};
}

/// The only fault, which must start with `start` and contain `words`.
void check_fault(const std::string& text, const std::string& start, const std::string& words,
                 const std::vector<std::string>& overrides = {}) {
    const std::vector<std::string> faults = faults_of(text, overrides);
    CAPTURE(text, faults);
    REQUIRE(faults.size() == 1);
    CHECK(faults[0].starts_with(start));
    CHECK(faults[0].find(words) != std::string::npos);
}

std::string with(const std::string& old, const std::string& fresh, std::string text = full_scenario) {
    const std::size_t at = text.find(old);
    REQUIRE(at != std::string::npos);
    return text.replace(at, old.size(), fresh);
}

std::string block_with(const std::string& shape) {
    return with("outline: [[0, 0], [1, 0], [1, 1], [0, 1]]", shape, small_scenario);
}

std::string expecting(const std::string& words) { return small_scenario + "expect:\n  - {" + words + "}\n"; }

}  // namespace

TEST_CASE("all faults come in one report, in the order of the lines") {
    const auto faults = faults_of(R"(gravity: [0, -9.81]
materials:
  granite: {density: -2600}
joints:
  rough:
    normal_stiffness: stiff
    shear_stiffness: 1e10
    friction_angle: 30
    cohesion: 1_000
blocks:
  - {name: a, outline: [[0, 0], [1, 0], [1, 1], [0, 1]], material: granit}
  - {name: b, outline: [[2, 0], [3, 1], [3, 0], [2, 1]]}
contacts: {default: ruogh}
run: {until: {time: 1}, solvr: auto}
water: {level: 3}
)");
    REQUIRE(faults.size() == 9);
    CHECK(faults[0] == "f.yaml:3 materials.granite.density: expected number (kg/m3), > 0, got \"-2600\"");
    CHECK(faults[1] == "f.yaml:6 joints.rough.normal_stiffness: expected number (Pa/m), > 0, got \"stiff\"");
    CHECK(faults[2] == "f.yaml:8 joints.rough.friction_angle: unknown key; did you mean friction_angle_deg?");
    CHECK(faults[3] == "f.yaml:9 joints.rough.cohesion: expected number (Pa), >= 0, got \"1_000\"");
    CHECK(faults[4] == "f.yaml:11 blocks[0].material: there is no material granit; did you mean granite?");
    CHECK(faults[5] == "f.yaml:12 blocks[1].outline: edge [0]-[1] meets edge [2]-[3] at (2.5, 0.5)");
    CHECK(faults[6] == "f.yaml:13 contacts.default: there is no joint ruogh; did you mean rough?");
    CHECK(faults[7] == "f.yaml:14 run.solvr: unknown key; did you mean solver?");
    CHECK(faults[8] == "f.yaml:15 water: not available yet");
}

TEST_CASE("what is not YAML is refused with its line") {
    CHECK(faults_of("").size() == 1);
    check_fault("run: {until: {time: 1}\nmaterials: [", "f.yaml:2 not valid YAML", "");
    check_fault("run:\n\t- 1\n", "f.yaml:2 not valid YAML", "");
    check_fault(small_scenario + "---\nrun: 1\n", "f.yaml:6", "second document");
    check_fault("a: &a [*a]\n", "f.yaml:1", "");
    CHECK(faults_of("just words").size() == 1);
}

TEST_CASE("a key given twice is refused with both lines, and so is a merge key") {
    check_fault(small_scenario + "gravity: [0, 0]\n", "f.yaml:5 gravity: given twice", "line 1");
    check_fault(with("density: 2500", "density: 2500, density: 2600", small_scenario),
                "f.yaml:2 materials.rock.density: given twice", "");
    check_fault(small_scenario + "record:\n  <<: {contacts: false}\n", "f.yaml:6 record.<<", "merge keys");
}

TEST_CASE("numbers follow the core rules of YAML 1.2 and are finite") {
    const auto density = [](const std::string& number) {
        return with("density: 2500", "density: " + number, small_scenario);
    };
    for (const char* good : {"2.5e3", "2500.", "+2500", "25E+2", ".5"}) CHECK(faults_of(density(good)).empty());
    for (const char* bad : {"0x10", "1_000", ".inf", ".nan", "1e999", "'2500'", "2500 kg", "1e", "\"\""})
        check_fault(density(bad), "f.yaml:2 materials.rock.density", "");
    check_fault(density("~"), "f.yaml:2 materials.rock.density", "has no value");
    check_fault(density("0"), "f.yaml:2 materials.rock.density", "> 0");
}

TEST_CASE("booleans are true and false, not yes and off") {
    CHECK(faults_of(small_scenario + "record: {contacts: False}\n").empty());
    check_fault(small_scenario + "record: {contacts: off}\n", "f.yaml:5 record.contacts", "expected true or false");
}

TEST_CASE("values of the wrong kind say what is expected") {
    check_fault(with("gravity: [0, -10]", "gravity: -10", small_scenario), "f.yaml:1 gravity", "list of 2 numbers (m/s2)");
    check_fault(with("gravity: [0, -10]", "gravity: [0, -10, 0]", small_scenario), "f.yaml:1 gravity", "has 3 items");
    check_fault(with("run: {until: {time: 1}}", "run: fast", small_scenario), "f.yaml:4 run", "got \"fast\"");
    check_fault(small_scenario + "stages: {settle: true}\n", "f.yaml:5 stages", "list of");
    check_fault(with("solver: explicit", "solver: explicitt"), "f.yaml:", "did you mean explicit?");
    check_fault(with("seed: 7", "seed: 7.5"), "f.yaml:", "whole number");
}

TEST_CASE("what belongs to later versions is refused in one line") {
    check_fault(small_scenario + "bolts: []\n", "f.yaml:5 bolts", "not available yet");
    check_fault(small_scenario + "deformation: {}\n", "f.yaml:5 deformation", "not available yet");
    check_fault(small_scenario + "strength_reduction: {}\n", "f.yaml:5 strength_reduction", "not available yet");
    check_fault(with("density: 2500", "density: 2500, young: 1e9", small_scenario), "f.yaml:2 materials.rock.young",
                "not available yet");
}

TEST_CASE("missing keys are named with the table they belong to") {
    check_fault(with("run: {until: {time: 1}}\n", "", small_scenario), "f.yaml:1 run.until", "is missing");
    check_fault(with("until: {time: 1}", "", small_scenario), "f.yaml:4 run.until", "is missing");
    check_fault(with("until: {time: 1}", "until: {}", small_scenario), "f.yaml:4 run.until",
                "at least one of time, equilibrium");
    check_fault(with("{density: 2500}", "{}", small_scenario), "f.yaml:2 materials.rock.density", "is missing");
    check_fault(small_scenario + "stages: [{name: x}]\n", "f.yaml:5 stages[0].until", "is missing");
    check_fault("run: {until: {time: 1}}\n", "f.yaml:1", "at least one of rock, blocks");
    check_fault(with("materials: {rock: {density: 2500}}", "", small_scenario), "f.yaml:3 blocks[0].material", "is missing");
}

TEST_CASE("a misspelt key is reported once, not also as missing") {
    check_fault(with("density", "densty", small_scenario), "f.yaml:2 materials.rock.densty", "did you mean density?");
    check_fault(block_with("outlin: [[0, 0], [1, 0], [1, 1]]"), "f.yaml:3 blocks[0].outlin", "did you mean outline?");
    check_fault(with("normal_stiffness: 2e10", "kn: 2e10"), "f.yaml:", "did you mean normal_stiffness?");
    check_fault(small_scenario + "colour: red\n", "f.yaml:5 colour: unknown key; known: title, source", "");
}

TEST_CASE("outlines that are no simple polygon are refused with the edges") {
    check_fault(block_with("outline: [[0, 0], [1, 0]]"), "f.yaml:3 blocks[0].outline", "at least 3");
    check_fault(block_with("outline: [[0, 0], [1, 0], [0, 0]]"), "f.yaml:3 blocks[0].outline", "2 different corners");
    check_fault(block_with("outline: [[0, 0], [1, 0], [2, 0]]"), "f.yaml:3 blocks[0].outline", "no area");
    check_fault(block_with("outline: [[0, 0], [1, 0], [1, 0], [0, 1]]"), "f.yaml:3 blocks[0].outline",
                "corner [2] repeats corner [1]");
    check_fault(block_with("outline: [[0, 0], [1, 1], [1, 0], [0, 1]]"), "f.yaml:3 blocks[0].outline", "(0.5, 0.5)");
    check_fault(block_with("outline: [[0, 0], [4, 0], [4, 4], [2, 0], [0, 4]]"), "f.yaml:3 blocks[0].outline",
                "edge [0]-[1] meets");
    check_fault(block_with("outline: [[0, 0], [4, 0], [4, 4], [4, 2], [4, 6], [0, 6]]"), "f.yaml:3 blocks[0].outline",
                "fold back");
    CHECK(faults_of(block_with("outline: [[0, 0], [1, 0], [1, 1], [0, 0]]")).empty());  // closed
    CHECK(faults_of(block_with("outline: [[0, 0], [0, 1], [1, 1]]")).empty());          // clockwise
}

TEST_CASE("names that do not exist are refused with the nearest one") {
    check_fault(with("joint: bedding}\n    - name", "joint: beding}\n    - name"),
                "f.yaml:", "there is no joint beding; did you mean bedding?");
    check_fault(with("region: cap", "region: cup"), "f.yaml:", "there is no region cup; did you mean cap?");
    check_fault(with("block: plate, quantity", "block: plaet, quantity"),
                "f.yaml:", "there is no block plaet; did you mean plate?");
    check_fault(with("{joints: {bedding: {cohesion", "{joints: {bedd: {cohesion"),
                "f.yaml:", "there is no joint bedd; did you mean bedding?");
    check_fault(with("a: granite, b", "a: marble, b"), "f.yaml:", "there is no material marble");
}

TEST_CASE("several joints without a default are refused, and touching blocks without any") {
    check_fault(with("  default: floor\n", ""), "f.yaml:", "there are several joints (bedding, floor, copy)");
    check_fault(block_with("rectangle: {corner: [0, 0], size: [1, 1]}, repeat: {count: 2, step: [1, 0]}"),
                "f.yaml:", "at least one joint");
}

TEST_CASE("two blocks, stages or histories of one name are refused") {
    check_fault(with("name: arch", "name: wall"), "f.yaml:", "a block or region of this name");
    check_fault(with("name: weaken", "name: excavate"), "f.yaml:", "a stage of this name");
    check_fault(with("name: joint,", "name: history1,"), "f.yaml:", "a history of this name");
}

TEST_CASE("values that contradict each other are refused") {
    check_fault(with("spacing: 2,", "spacing: 0,"), "f.yaml:", "> 0");
    check_fault(with("persistence: 0.8", "persistence: 1.2"), "f.yaml:", "0 (excluded) to 1");
    check_fault(with("friction_angle_deg: 45", "friction_angle_deg: 90"), "f.yaml:", "0 to 90 (excluded)");
    check_fault(with("friction_angle_deg: 45", "friction_angle_deg: 45, residual: {cohesion: 1}"),
                "f.yaml:", "above the peak value");
    check_fault(with("friction_angle_deg: 45", "friction_angle_deg: 45, dilation_angle_deg: 46"),
                "f.yaml:", "above the friction angle");
    check_fault(
        with("friction_angle_deg: 45", "friction_angle_deg: 45, dilation_angle_deg: 20, residual: {friction_angle_deg: 10}"),
        "f.yaml:", "above the residual friction angle");
    check_fault(with("bedding: {cohesion: 5e4}", "bedding: {cells: 4}"), "f.yaml:", "cells: unknown key");
    check_fault(with("time: [0, 0.5, 1]", "time: [0, 0.5, 0.5]"), "f.yaml:", "times must increase");
    check_fault(with("value: [0, 0.5]", "value: [0, 0.5, 1]"), "f.yaml:", "has 3 values for 2 times");
    check_fault(with("thickness: 1,", "thickness: 10,"), "f.yaml:", "below twice the radius");
    check_fault(with("{settle: true}", "{settle: true, release: 1}"), "f.yaml:", "nothing to release");
}

TEST_CASE("an expectation that cannot be judged is refused") {
    const std::string at = "f.yaml:6 expect[0]";
    check_fault(expecting("quantity: spin, block: cube"), at, "exactly one of value, same_as, above, below");
    check_fault(expecting("quantity: spin, block: cube, value: 1"), at + ".value", "needs tolerance");
    check_fault(expecting("quantity: spin, block: cube, value: 0, tolerance: 0.1"), at + ".tolerance", "tolerance_absolute");
    check_fault(expecting("quantity: spin, block: cube, above: 1, below: 2"), at,
                "takes only one of value, same_as, above, below");
    check_fault(expecting("quantity: spin, above: 1"), at, "spin needs: point or block");
    check_fault(expecting("quantity: slip, block: cube, above: 1"), at, "slip needs: joint");
    check_fault(expecting("quantity: unbalanced, block: cube, above: 1"), at, "unbalanced needs: none");
    check_fault(expecting("quantity: rotaton, block: cube, above: 1"), at + ".quantity", "did you mean rotation?");
    check_fault(expecting("quantity: position, block: cube, above: 1"), at + ".component", "x | y | along");
    check_fault(expecting("quantity: spin, component: x, block: cube, above: 1"), at + ".component", "no component x");
    check_fault(expecting("quantity: velocity, component: along, block: cube, above: 1"), at + ".direction_deg",
                "is missing");
    check_fault(expecting("quantity: acceleration, block: cube, above: 1"), at + ".between", "is missing");
    check_fault(expecting("quantity: acceleration, block: cube, above: 1, between: [2, 1]"), at + ".between", "increase");
    check_fault(expecting("quantity: stable, above: 1"), at, "takes no value");
    check_fault(expecting("quantity: spin, block: cube, above: 1, limit: 3"), at + ".limit", "stable");
    check_fault(expecting("quantity: frequency, component: magnitude, block: cube, above: 1"), at + ".component",
                "magnitude");
}

TEST_CASE("an override that leads nowhere names the nearest right key") {
    check_fault(full_scenario, "--set run.untl.time", "did you mean until?", {"run.untl.time=3"});
    check_fault(full_scenario, "--set joints.beding.cohesion", "did you mean bedding?", {"joints.beding.cohesion=3"});
    check_fault(full_scenario, "--set blocks[9].spin", "the list has 4", {"blocks[9].spin=3"});
    check_fault(full_scenario, "--set title.x", "leads nowhere", {"title.x=3"});
    check_fault(full_scenario, "--set run", "expected path=value", {"run"});
    check_fault(full_scenario, "--set run.threads", "got \"many\"", {"run.threads=many"});
    check_fault(full_scenario, "--set water.level", "not available yet", {"water.level=1"});
}

TEST_CASE("faults of cases stand at their rows, and common ones are told once") {
    const auto faults = faults_of(small_scenario + R"(colour: red
cases:
  - {name: a, set: {run.until.tme: 3}}
  - {name: b, set: {run.until.time: -3}, expect: [{quantity: spin, block: cube}]}
  - {nam: c}
)");
    REQUIRE(faults.size() == 5);
    CHECK(faults[0].starts_with("f.yaml:5 colour"));
    CHECK(faults[1] == "f.yaml:7 cases[0].set.run.until.tme: tme is an unknown key; did you mean time?");
    CHECK(faults[2].starts_with("f.yaml:8 cases[1].expect[0]: needs exactly one"));
    CHECK(faults[3].starts_with("f.yaml:8 run.until.time: expected number (s), > 0"));
    CHECK(faults[4].starts_with("f.yaml:9 cases[2].nam: unknown key"));
}

TEST_CASE("a file that cannot be read is refused by name") {
    CHECK_THROWS_WITH(read_scenario("no/such/file.yaml"), Catch::Contains("no/such/file.yaml: cannot be read"));
    CHECK_THROWS_AS(read_scenario("."), InputError);
    check_fault(with("outline: [[0, 0], [60, 0], [60, 15], [40, 15], [25, 40], [0, 40]]", "outline_file: gone.geojson"),
                "f.yaml:", "gone.geojson");
}

TEST_CASE("rounded corners are refused where they cannot be: other solvers, bonds, the general form, an accuracy") {
    const std::string joint = "joints: {rough: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 30";
    const auto scene = [&](const std::string& run, const std::string& strength = "") {
        return with("run: {until: {time: 1}}",
                    joint + strength + "}}\nrun: {until: {time: 1}, rounding_length: " + run + "}", small_scenario);
    };
    CHECK(faults_of(scene("0.01")).empty());
    check_fault(scene("0"), "f.yaml:5 run.rounding_length", "> 0");
    check_fault(scene("0.01, solver: rigid"), "f.yaml:5 run.rounding_length", "belongs to the explicit solver");
    check_fault(scene("0.01, face_path: false"), "f.yaml:5 run.rounding_length", "leave one of them out");
    check_fault(scene("0.01, accuracy: 1e-2"), "f.yaml:5 run.rounding_length", "leave one of them out");
    check_fault(scene("0.01", ", cohesion: 1e4"), "f.yaml:4 joints.rough.cohesion", "no bonds");
    check_fault(scene("0.01", ", tension: 1e4"), "f.yaml:4 joints.rough.tension", "no bonds");
}

TEST_CASE("a file without anything in it is told by its name and line") {
    check_fault("", "f.yaml:1", "has no value");
    check_fault("# nothing yet\n", "f.yaml:1", "has no value");
}

TEST_CASE("a history cannot have the name of a path: results are not touched before that is known") {
    for (const char* name : {"a/b", ".", ""})
        check_fault(small_scenario + "record: {history: [{name: \"" + name + "\", quantity: energy}]}\n",
                    "f.yaml:", "name of a group of the results");
}

TEST_CASE("forces of deleted blocks fade away within the stage") {
    const std::string stage = "stages: [{name: dig, delete: [{at: [0.5, 0.5]}], release: 1, until: {time: 0.2}}]\n";
    check_fault(small_scenario + stage, "f.yaml:", "longer than the stage");
}
