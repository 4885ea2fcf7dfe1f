// The specification as a JSON Schema. Shapes with a title become definitions.
#include "scenario/reader.hpp"
#include "scenario/specification.hpp"
#include "scenario/yaml_file.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

using nlohmann::ordered_json;
using Kind = spec::Shape::Kind;

class SchemaWriter {
public:
    ordered_json whole(const spec::Shape& scenario) {
        ordered_json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "Talus scenario"}};
        schema.update(body(scenario));
        schema["$defs"] = definitions_;
        return schema;
    }

private:
    ordered_json reference(const spec::Shape& shape) {
        if (shape.title.empty()) return body(shape);
        std::string name = shape.title;
        std::replace(name.begin(), name.end(), ' ', '_');
        if (!definitions_.contains(name)) {
            definitions_[name] = nullptr;  // keeps its place before the definitions it needs
            ordered_json definition = body(shape);
            definitions_[name] = std::move(definition);
        }
        return {{"$ref", "#/$defs/" + name}};
    }

    ordered_json body(const spec::Shape& shape) {
        ordered_json out = ordered_json::object();
        if (!shape.meaning.empty()) out["description"] = shape.meaning;
        switch (shape.kind) {
            case Kind::number:
            case Kind::integer:
                add_number(shape, out);
                break;
            case Kind::boolean:
                out["type"] = "boolean";
                break;
            case Kind::text:
                out["type"] = {"string", "number", "boolean"};
                break;  // a title may be 1984
            case Kind::choice:
                out["enum"] = shape.words;
                break;
            case Kind::list:
                add_list(shape, out);
                break;
            case Kind::names:
                out["type"] = "object";
                out["additionalProperties"] = reference(shape.of.front());
                break;
            case Kind::table:
                add_table(shape, out);
                break;
            case Kind::either:
                for (const spec::Shape& alternative : shape.of) out["anyOf"].push_back(reference(alternative));
                break;
            case Kind::anything:
                break;
        }
        return out;
    }

    static void add_number(const spec::Shape& shape, ordered_json& out) {
        out["type"] = shape.kind == Kind::integer ? "integer" : "number";
        if (std::isfinite(shape.range.low)) out[shape.range.open_low ? "exclusiveMinimum" : "minimum"] = shape.range.low;
        if (std::isfinite(shape.range.high)) out[shape.range.open_high ? "exclusiveMaximum" : "maximum"] = shape.range.high;
    }

    void add_list(const spec::Shape& shape, ordered_json& out) {
        out["type"] = "array";
        out["items"] = reference(shape.of.front());
        if (shape.least > 0) out["minItems"] = shape.least;
        if (shape.most != spec::Shape::unlimited) out["maxItems"] = shape.most;
    }

    void add_table(const spec::Shape& shape, ordered_json& out) {
        out["type"] = "object";
        out["additionalProperties"] = false;
        out["properties"] = ordered_json::object();
        ordered_json required = ordered_json::array();
        for (const spec::Key& key : shape.keys) {
            ordered_json property = reference(key.shape);
            property["description"] = described(key);
            if (!key.presence.value.empty()) {
                std::vector<Fault> none;
                property["default"] = ordered_json::parse(to_json(parse_yaml(key.presence.value, "default", none)));
            }
            out["properties"][key.name] = std::move(property);
            if (key.presence.required) required.push_back(key.name);
        }
        if (!required.empty()) out["required"] = required;
        for (const spec::Rule& rule : shape.rules) out["allOf"].push_back(rule_schema(rule));
    }

    static std::string described(const spec::Key& key) {
        const std::string unit = key.shape.unit.empty() || key.shape.unit == "1" ? "" : " [" + key.shape.unit + "]";
        const std::string words = key.presence.words.empty() ? "" : " (default: " + key.presence.words + ")";
        return key.meaning + unit + words;
    }

    static ordered_json rule_schema(const spec::Rule& rule) {
        ordered_json each = ordered_json::array(), pairs = ordered_json::array();
        for (std::size_t i = 0; i < rule.keys.size(); ++i) {
            each.push_back({{"required", {rule.keys[i]}}});
            for (std::size_t j = i + 1; j < rule.keys.size(); ++j)
                pairs.push_back({{"required", {rule.keys[i], rule.keys[j]}}});
        }
        if (rule.count == spec::Rule::Count::exactly_one) return {{"oneOf", each}};
        if (rule.count == spec::Rule::Count::at_least_one) return {{"anyOf", each}};
        return {{"not", {{"anyOf", pairs}}}};
    }

    ordered_json definitions_ = ordered_json::object();
};

}  // namespace

std::string scenario_schema() { return SchemaWriter().whole(spec::scenario()).dump(2) + "\n"; }

}  // namespace talus
