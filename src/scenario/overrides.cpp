#include "scenario/overrides.hpp"

#include "scenario/check.hpp"
#include "scenario/nearest.hpp"
#include "scenario/yaml_file.hpp"

#include <algorithm>

namespace talus {
namespace {

// a.b[0].c -> a, b, 0, c
std::vector<std::string> split(const std::string& path) {
    std::vector<std::string> steps(1);
    for (const char c : path) {
        if (c == '.' || c == '[')
            steps.emplace_back();
        else if (c != ']')
            steps.back() += c;
    }
    return steps;
}

bool is_index(const std::string& step) {
    return !step.empty() && step.size() < 9 &&
           std::all_of(step.begin(), step.end(), [](char c) { return c >= '0' && c <= '9'; });
}

// The part of a shape that a step of a path can enter.
const spec::Shape* enterable(const spec::Shape& shape, bool index) {
    if (shape.kind == spec::Shape::Kind::either) {
        for (const spec::Shape& alternative : shape.of)
            if (const spec::Shape* found = enterable(alternative, index)) return found;
        return nullptr;
    }
    const bool map = shape.kind == spec::Shape::Kind::table || shape.kind == spec::Shape::Kind::names;
    return (index ? shape.kind == spec::Shape::Kind::list : map) ? &shape : nullptr;
}

struct Place {  // where a path has led so far
    Value* value;
    const spec::Shape* shape;
};

void set_line(Value& value, int line) {
    value.line = line;
    for (Value& item : value.items) set_line(item, line);
    for (Entry& entry : value.entries) entry.line = line, set_line(entry.value, line);
}

std::vector<std::string> keys_of(const Value& value) {
    std::vector<std::string> keys;
    for (const Entry& entry : value.entries) keys.push_back(entry.key);
    return keys;
}

/// One step; returns what is wrong with it, or nothing.
std::string enter(Place& at, const std::string& step, int line) {
    if (is_index(step) && at.value->is(Value::Kind::list)) {
        const spec::Shape* list = enterable(*at.shape, true);
        const std::size_t i = std::stoul(step), n = at.value->items.size();
        if (!list || i >= n) return "there is no item " + step + "; the list has " + std::to_string(n);
        at = {&at.value->items[i], &list->of.front()};
        return {};
    }
    const spec::Shape* map = enterable(*at.shape, false);
    if (!map) return step + " leads nowhere; here stands " + at.shape->text();
    if (at.value->is_null()) at.value->kind = Value::Kind::map, at.value->line = line;
    if (!at.value->is(Value::Kind::map)) return step + " leads nowhere; here stands no table";
    if (map->kind == spec::Shape::Kind::names) {
        Value* named = at.value->find(step);
        if (!named) return "there is no " + step + hint(step, keys_of(*at.value));
        at = {named, &map->of.front()};
        return {};
    }
    const spec::Key* key = map->find(step);
    if (!key && std::find(map->later.begin(), map->later.end(), step) != map->later.end())
        return step + " is not available yet";
    if (!key) return step + " is an unknown key" + hint(step, map->key_names());
    Value* child = at.value->find(step);
    at = {child ? child : &at.value->set(step, Value{}, line), &key->shape};
    return {};
}

}  // namespace

std::vector<Override> parse_overrides(const std::vector<std::string>& texts, std::vector<Fault>& faults) {
    std::vector<Override> all;
    for (const std::string& text : texts) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || equals == 0) {
            faults.push_back({place_of({}, 0), text, "expected path=value, e.g. run.until.time=2"});
            continue;
        }
        const std::string path = text.substr(0, equals);
        std::vector<Fault> in_value;
        Value value = parse_yaml(text.substr(equals + 1), "--set", in_value);
        for (Fault& fault : in_value) faults.push_back({place_of({}, 0), path, fault.message});
        set_line(value, 0);
        all.push_back({path, std::move(value), path});
    }
    return all;
}

void apply(const Override& change, const spec::Shape& shape, const std::string& file, Value& tree,
           std::vector<Fault>& faults) {
    Value changed = tree;  // a path that fails half way leaves no empty tables behind
    Place at{&changed, &shape};
    for (const std::string& step : split(change.path)) {
        const std::string problem = enter(at, step, change.value.line);
        if (problem.empty()) continue;
        faults.push_back({place_of(file, change.value.line), change.key, problem});
        return;
    }
    *at.value = change.value;
    tree = std::move(changed);
}

}  // namespace talus
