#include "scenario/reader.hpp"

#include "core/fnv1a.hpp"
#include "scenario/check.hpp"
#include "scenario/convert.hpp"
#include "scenario/derive.hpp"
#include "scenario/overrides.hpp"
#include "scenario/specification.hpp"
#include "scenario/yaml_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <tuple>

namespace talus {
namespace {

struct Input {
    std::string text, file, folder;
};

Input load(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    if (file && !std::filesystem::is_directory(path)) text << file.rdbuf();
    if (!file || std::filesystem::is_directory(path)) throw InputError(path + ": cannot be read");
    return {text.str(), path, std::filesystem::path(path).parent_path().string()};
}

// Hash of everything the scenario says, and of what is in the files it only names.
void sign(const Input& input, Scenario& scenario) {
    const auto add = [&](const std::string& file) {
        if (file.empty()) return;
        const Input named = load((std::filesystem::path(input.folder) / file).string());
        scenario.files.emplace_back(file, fnv1a(named.text));
    };
    if (scenario.rock) add(scenario.rock->outline_file);
    if (scenario.rock && scenario.rock->traces) add(scenario.rock->traces->file);
    std::string all = scenario.canonical_json;
    for (const auto& [file, hash] : scenario.files) all += "\n" + std::to_string(hash);
    scenario.hash = fnv1a(all);
}

[[noreturn]] void report(std::vector<Fault> faults) {
    const auto order = [](const Fault& fault) {
        return std::tie(fault.where.line, fault.where.file, fault.key, fault.message);
    };
    std::stable_sort(faults.begin(), faults.end(), [&](const Fault& a, const Fault& b) { return order(a) < order(b); });
    const auto same = [&](const Fault& a, const Fault& b) {
        return order(a) == order(b);
    };  // cases share most of their keys
    faults.erase(std::unique(faults.begin(), faults.end(), same), faults.end());
    throw InputError(std::move(faults));
}

/// Zero if the scene is near enough to (0, 0) for double numbers, else the lower left corner in whole metres.
Vec2 automatic_origin(const Scenario& scenario) {
    const double most = std::numeric_limits<double>::max();
    Vec2 low(most, most), high(-most, -most);
    const auto include = [&](const Polygon& outline) {
        for (const Vec2& corner : outline) low = low.cwiseMin(corner), high = high.cwiseMax(corner);
    };
    if (scenario.rock) include(scenario.rock->outline);
    for (const BlockSpec& block : scenario.blocks) include(block.outline);
    if (low.x() > high.x()) return Vec2::Zero();
    const double far = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
    if (far <= 100.0 * (high - low).maxCoeff()) return Vec2::Zero();
    return {std::floor(low.x()), std::floor(low.y())};
}

Scenario convert_with_origin(const Input& input, Value& checked, std::vector<Fault>& faults) {
    const auto convert_at = [&](const Vec2& origin, Reading& reading) {
        reading = {};
        reading.file = input.file;
        reading.folder = input.folder;
        reading.origin = origin;
        return convert(Cursor(checked, "", checked.line, reading));
    };
    Reading reading;
    const Value* given = checked.find("origin");
    const bool automatic = !given || !given->is(Value::Kind::list);
    Scenario scenario =
        convert_at(automatic ? Vec2(Vec2::Zero()) : Vec2(given->items[0].number, given->items[1].number), reading);
    if (automatic) {
        if (const Vec2 origin = automatic_origin(scenario); !origin.isZero(0.0)) scenario = convert_at(origin, reading);
        checked.set("origin",
                    Value::of_list({Value::of_number(scenario.origin.x()), Value::of_number(scenario.origin.y())}));
    }
    faults.insert(faults.end(), reading.faults.begin(), reading.faults.end());
    return scenario;
}

/// It must end: by `run.until`, or with the last stage. Then nothing of `run` holds that belongs to a stage.
void check_end(const Scenario& scenario, const Value& checked, const std::string& file, std::vector<Fault>& faults) {
    const RunSpec& run = scenario.run;
    const auto said = [](const Fault& fault) { return fault.key == "run" || fault.key.starts_with("run."); };
    if (run.until.time || run.until.equilibrium || std::any_of(faults.begin(), faults.end(), said)) return;
    const Value* at = checked.find("run");
    const auto fault = [&](const std::string& key, const std::string& message) {
        const Value* value = at ? at->find(key) : nullptr;
        faults.push_back({place_of(file, value ? value->line : at ? at->line : checked.line), "run." + key, message});
    };
    const std::string goes_with = "goes with run.until: without it the last of `stages` is the end";
    if (scenario.stages.empty())
        fault("until", "is missing: when the run ends");
    else if (run.time_step)
        fault("time_step", goes_with);
    else if (run.damping.local != 0.0 || run.damping.contact != 0.0)
        fault("damping", goes_with);
}

/// One scenario from the tree as it was read.
Scenario make_scenario(const Input& input, Value tree, std::vector<Fault>& faults) {
    fill_derived_defaults(tree);
    fill_fixed_defaults(tree);
    const Value* run = tree.find("run");
    const spec::Shape& shape = run && run->find("accuracy") ? spec::scenario() : spec::scenario_without_accuracy();
    Value checked = check(tree, shape, "", input.file, faults);
    if (!checked.is(Value::Kind::map)) return {};
    checked.erase("cases");
    Scenario scenario = convert_with_origin(input, checked, faults);
    check_end(scenario, checked, input.file, faults);
    scenario.text = input.text;
    scenario.canonical_json = to_json(checked);
    if (faults.empty()) sign(input, scenario);
    return scenario;
}

Value parse(const Input& input, std::vector<Fault>& faults) {
    Value tree = parse_yaml(input.text, input.file, faults);
    if (tree.is_null() && !faults.empty()) report(faults);  // a syntax error hides all the rest
    return tree;
}

/// The tree with overrides, which are noted at the end of the text.
Value changed(Value tree, Input& input, const std::vector<std::string>& overrides, std::vector<Fault>& faults) {
    for (const Override& change : parse_overrides(overrides, faults))
        apply(change, spec::scenario(), input.file, tree, faults);
    for (const std::string& text : overrides) input.text += "\n# --set " + text;
    return tree;
}

Value read_tree(Input& input, const std::vector<std::string>& overrides, std::vector<Fault>& faults) {
    return changed(parse(input, faults), input, overrides, faults);
}

Value with_row(const Value& tree, const Value& row, const std::string& path, const Input& input,
               std::vector<Fault>& faults) {
    Value changed = tree;
    if (const Value* set = row.find("set"))
        for (const Entry& entry : set->entries)
            apply({entry.key, entry.value, path + ".set." + entry.key}, spec::scenario(), input.file, changed, faults);
    if (const Value* expect = row.find("expect")) changed.set("expect", *expect, expect->line);
    return changed;
}

/// Expectations can only be the same as those of a case that stands above, at the same place of its list.
void check_likened(const std::vector<Case>& rows, std::vector<Fault>& faults) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const std::vector<ExpectSpec>& expects = rows[i].scenario.expect;
        for (std::size_t k = 0; k < expects.size(); ++k) {
            if (expects[k].same_as.empty()) continue;
            const bool there = std::any_of(
                rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(i),
                [&](const Case& row) { return row.name == expects[k].same_as && row.scenario.expect.size() > k; });
            if (!there)
                faults.push_back({expects[k].where, "expect[" + std::to_string(k) + "].same_as",
                                  "no case `" + expects[k].same_as + "` above expects something at this place of its list"});
        }
    }
}

std::vector<Case> cases_of(Input input, const std::vector<std::string>& overrides) {
    std::vector<Fault> faults;
    Value tree = read_tree(input, overrides, faults);
    const Value* rows = tree.find("cases");
    std::vector<Case> all;
    if (!rows) {
        all.push_back({"", make_scenario(input, tree, faults)});
    } else {
        fill_derived_defaults(tree);  // names of cases
        const Value cases = *tree.find("cases");
        check(cases, spec::scenario().find("cases")->shape, "cases", input.file, faults);
        tree.erase("cases");
        for (std::size_t i = 0; i < cases.items.size(); ++i) {
            const Value& row = cases.items[i];
            const Value* name = row.find("name");
            Input noted = input;
            noted.text += "\n# case: " + (name ? name->text : std::to_string(i + 1));
            const std::string path = "cases[" + std::to_string(i) + "]";
            std::vector<Fault> found;
            Value changed = with_row(tree, row, path, input, found);
            all.push_back({name ? name->text : "", make_scenario(noted, std::move(changed), found)});
            for (Fault& fault : found) {
                if (row.find("expect") && fault.key.starts_with("expect[")) fault.key = path + "." + fault.key;
                faults.push_back(std::move(fault));
            }
        }
    }
    if (faults.empty()) check_likened(all, faults);
    if (!faults.empty()) report(std::move(faults));
    return all;
}

Scenario scenario_of(const Input& input, const Value& tree, std::vector<Fault>& faults) {
    Scenario scenario = make_scenario(input, tree, faults);
    if (!faults.empty()) report(std::move(faults));
    return scenario;
}

Scenario scenario_of(Input input, const std::vector<std::string>& overrides) {
    std::vector<Fault> faults;
    const Value tree = read_tree(input, overrides, faults);
    return scenario_of(input, tree, faults);
}

}  // namespace

Scenario read_scenario(const std::string& path, const std::vector<std::string>& overrides) {
    return scenario_of(load(path), overrides);
}

struct ScenarioFile::Content {
    Input input;
    std::vector<Fault> faults;  // that do not keep the rest from being looked at
    Value tree;
};

ScenarioFile::ScenarioFile(const std::string& path) {
    Content content{load(path), {}, {}};
    content.tree = parse(content.input, content.faults);
    content_ = std::make_shared<const Content>(std::move(content));
}

Scenario ScenarioFile::with(const std::vector<std::string>& overrides) const {
    Input input = content_->input;
    std::vector<Fault> faults = content_->faults;
    const Value tree = changed(content_->tree, input, overrides, faults);
    return scenario_of(input, tree, faults);
}

std::vector<Case> read_cases(const std::string& path, const std::vector<std::string>& overrides) {
    return cases_of(load(path), overrides);
}

Scenario read_scenario_text(const std::string& text, const std::string& file_name, const std::string& folder,
                            const std::vector<std::string>& overrides) {
    return scenario_of({text, file_name, folder}, overrides);
}

std::vector<Case> read_cases_text(const std::string& text, const std::string& file_name, const std::string& folder,
                                  const std::vector<std::string>& overrides) {
    return cases_of({text, file_name, folder}, overrides);
}

}  // namespace talus
