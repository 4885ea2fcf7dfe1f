#include "scenario/derive.hpp"

#include <string>
#include <vector>

namespace talus {
namespace {

// The table under a key, made if it is not there; nullptr if something else stands there.
Value* table_at(Value& parent, const std::string& key) {
    Value* child = parent.find(key);
    if (!child) {
        child = &parent.set(key, Value::of_map(), parent.line);
        child->line = parent.line;
    }
    return child->is(Value::Kind::map) ? child : nullptr;
}

void fill(Value* table, const std::string& key, Value value) {
    if (!table || !table->is(Value::Kind::map) || table->find(key)) return;
    value.line = table->line;
    table->set(key, std::move(value), table->line);
}

std::vector<Value>* list_at(Value& parent, const std::string& key) {
    Value* list = parent.find(key);
    return list && list->is(Value::Kind::list) ? &list->items : nullptr;
}

void fill_names(Value& parent, const std::string& key, const std::string& word) {
    std::vector<Value>* items = list_at(parent, key);
    for (std::size_t i = 0; items && i < items->size(); ++i)
        fill(&(*items)[i], "name", Value::of_text(word + std::to_string(i + 1)));
}

// The name if a table of names holds exactly one.
std::string only_name(const Value& scenario, const std::string& key) {
    const Value* names = scenario.find(key);
    return names && names->entries.size() == 1 ? names->entries[0].key : "";
}

std::optional<double> number_of(const Value* value) {
    return value && value->is(Value::Kind::raw) && !value->quoted ? as_number(value->text) : std::nullopt;
}

void fill_rock(Value& rock) {
    fill_names(rock, "joint_sets", "set");
    std::vector<Value>* sets = list_at(rock, "joint_sets");
    for (std::size_t i = 0; sets && i < sets->size(); ++i) {
        const Value* spacing = (*sets)[i].find("spacing");
        if (spacing && spacing->is(Value::Kind::map)) spacing = spacing->find("mean");
        const auto mean = number_of(spacing), persistence = number_of((*sets)[i].find("persistence"));
        // Long enough to cut through the blocks between neighbouring lines, short enough for bridges to matter.
        if (mean && persistence && *persistence < 1.0) fill(&(*sets)[i], "trace_length", Value::of_number(5.0 * *mean));
    }
}

void fill_settling(Value& stage) {
    const Value* settle = stage.find("settle");
    if (!settle || !settle->is(Value::Kind::raw) || settle->quoted || !as_boolean(settle->text).value_or(false)) return;
    Value yes = Value::of_text("true");
    yes.quoted = false;
    fill(&stage, "reset", yes);
    const Value* solver = stage.find("solver");
    if (!solver || solver->text != "static") fill(table_at(stage, "damping"), "local", Value::of_number(0.8));
    fill(table_at(stage, "until"), "equilibrium", Value::of_number(1e-6));
}

}  // namespace

void fill_fixed_defaults(Value& scenario) {
    Value* run = scenario.is(Value::Kind::map) ? table_at(scenario, "run") : nullptr;
    if (!run || run->find("accuracy")) return;
    fill(run, "step_fraction", Value::of_number(0.8));
    fill(run, "freeze", Value::of_text("never"));
}

void fill_derived_defaults(Value& scenario) {
    if (!scenario.is(Value::Kind::map)) return;
    if (const std::string joint = only_name(scenario, "joints"); !joint.empty())
        fill(table_at(scenario, "contacts"), "default", Value::of_text(joint));
    fill_names(scenario, "blocks", "block");
    fill_names(scenario, "stages", "stage");
    fill_names(scenario, "cases", "case");
    if (Value* record = table_at(scenario, "record")) {
        fill_names(*record, "history", "history");
        Value* frames = table_at(*record, "frames");
        if (frames && !frames->find("every")) fill(frames, "count", Value::of_number(50));
    }

    const std::string material = only_name(scenario, "materials");
    std::vector<Value>* blocks = list_at(scenario, "blocks");
    for (std::size_t i = 0; blocks && !material.empty() && i < blocks->size(); ++i)
        fill(&(*blocks)[i], "material", Value::of_text(material));
    if (Value* rock = scenario.find("rock"); rock && rock->is(Value::Kind::map)) {
        if (!material.empty()) fill(rock, "material", Value::of_text(material));
        fill_rock(*rock);
    }
    std::vector<Value>* stages = list_at(scenario, "stages");
    for (std::size_t i = 0; stages && i < stages->size(); ++i) fill_settling((*stages)[i]);
}

}  // namespace talus
