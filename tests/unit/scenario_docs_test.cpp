// The reference, the schema and the reader say the same. TALUS_WRITE_DOCS=1 in the environment writes the files instead.
#include "scenario/reader.hpp"
#include "scenario/specification.hpp"
#include "scenario/yaml_file.hpp"
#include "support/catch.hpp"
#include "unit/scenario_text.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

using namespace talus;

namespace {

const std::filesystem::path root = TALUS_SOURCE_DIR;
const std::string begin_mark = "<!-- begin of what the program writes -->\n",
                  end_mark = "<!-- end of what the program writes -->\n";

std::string read_file(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

void compare(const std::filesystem::path& path, const std::string& expected) {
    if (std::getenv("TALUS_WRITE_DOCS")) std::ofstream(path, std::ios::binary) << expected;
    INFO(path.filename().string() << " is out of date; write it with TALUS_WRITE_DOCS=1 bin/test_unit");
    CHECK((read_file(path) == expected));
}

Value parse(const std::string& text) {
    std::vector<Fault> faults;
    return parse_yaml(text, "", faults);
}

/// The part of JSON Schema that the schema of scenarios uses.
class Validator {
public:
    explicit Validator(const Value& schema) : schema_(schema) {}
    bool accepts(const Value& value) const { return accepts(value, schema_); }

private:
    bool accepts(const Value& value, const Value& schema) const {
        if (const Value* reference = schema.find("$ref")) {
            const Value* definition = schema_.find("$defs")->find(reference->text.substr(std::string("#/$defs/").size()));
            if (!definition || !accepts(value, *definition)) return false;
        }
        if (const Value* type = schema.find("type"); type && !has_type(value, *type)) return false;
        if (const Value* words = schema.find("enum"))
            if (std::none_of(words->items.begin(), words->items.end(), [&](const Value& w) { return w.text == value.text; }))
                return false;
        return in_range(value, schema) && accepts_items(value, schema) && accepts_keys(value, schema) &&
               accepts_all(value, schema);
    }

    static bool has_type(const Value& value, const Value& type) {
        if (type.is(Value::Kind::list))
            return std::any_of(type.items.begin(), type.items.end(), [&](const Value& t) { return has_type(value, t); });
        if (type.text == "object") return value.is(Value::Kind::map);
        if (type.text == "array") return value.is(Value::Kind::list);
        if (!value.is(Value::Kind::raw)) return false;
        const bool number = !value.quoted && as_number(value.text), boolean = !value.quoted && as_boolean(value.text);
        if (type.text == "number") return number;
        if (type.text == "integer") return number && *as_number(value.text) == std::floor(*as_number(value.text));
        if (type.text == "boolean") return boolean;
        return type.text == "string" && !number && !boolean;
    }

    static bool in_range(const Value& value, const Value& schema) {
        const auto number = value.is(Value::Kind::raw) ? as_number(value.text) : std::nullopt;
        if (!number) return true;
        const auto bound = [&](const char* key, auto holds) {
            const Value* limit = schema.find(key);
            return !limit || holds(*number, *as_number(limit->text));
        };
        return bound("minimum", std::greater_equal<>()) && bound("exclusiveMinimum", std::greater<>()) &&
               bound("maximum", std::less_equal<>()) && bound("exclusiveMaximum", std::less<>());
    }

    bool accepts_items(const Value& value, const Value& schema) const {
        const Value *item = schema.find("items"), *least = schema.find("minItems"), *most = schema.find("maxItems");
        if (least && value.items.size() < static_cast<std::size_t>(*as_number(least->text))) return false;
        if (most && value.items.size() > static_cast<std::size_t>(*as_number(most->text))) return false;
        return !item ||
               std::all_of(value.items.begin(), value.items.end(), [&](const Value& v) { return accepts(v, *item); });
    }

    bool accepts_keys(const Value& value, const Value& schema) const {
        const Value *properties = schema.find("properties"), *other = schema.find("additionalProperties");
        if (const Value* required = schema.find("required"))
            for (const Value& key : required->items)
                if (!value.find(key.text)) return false;
        for (const Entry& entry : value.entries) {
            const Value* property = properties ? properties->find(entry.key) : nullptr;
            if (!property && other && other->text == "false") return false;
            const Value* wanted = property ? property : other;
            if (wanted && !accepts(entry.value, *wanted)) return false;
        }
        return true;
    }

    bool accepts_all(const Value& value, const Value& schema) const {
        const auto count = [&](const Value* some) {
            return std::count_if(some->items.begin(), some->items.end(), [&](const Value& s) { return accepts(value, s); });
        };
        const Value *all = schema.find("allOf"), *any = schema.find("anyOf"), *one = schema.find("oneOf"),
                    *none = schema.find("not");
        return (!all || count(all) == static_cast<long>(all->items.size())) && (!any || count(any) > 0) &&
               (!one || count(one) == 1) && (!none || !accepts(value, *none));
    }

    const Value& schema_;
};

std::vector<std::filesystem::path> scenario_files() {
    std::vector<std::filesystem::path> files;
    if (std::filesystem::exists(root / "scenarios"))
        for (const auto& entry : std::filesystem::recursive_directory_iterator(root / "scenarios"))
            if (entry.path().extension() == ".yaml") files.push_back(entry.path());
    return files;
}

}  // namespace

TEST_CASE("the schema in docs is the one the program writes") {
    compare(root / "docs/scenario.schema.json", scenario_schema());
}

TEST_CASE("the tables of the scenario reference are those the program writes") {
    const std::filesystem::path path = root / "docs/scenario-reference.md";
    const std::string text = read_file(path);
    const std::size_t begin = text.find(begin_mark), end = text.find(end_mark);
    REQUIRE(begin != std::string::npos);
    REQUIRE(end != std::string::npos);
    compare(path, text.substr(0, begin + begin_mark.size()) + "\n" + scenario_reference_tables() + "\n" + text.substr(end));
}

TEST_CASE("the schema accepts what the reader accepts") {
    const Value schema = parse(scenario_schema());
    const Validator validator(schema);
    for (const std::string& text : {test::full_scenario, test::small_scenario}) {
        CHECK(validator.accepts(parse(text)));
        CHECK(validator.accepts(parse(read_scenario_text(text, "", "").canonical_json)));
    }
    for (const auto& file : scenario_files()) {
        INFO(file.string());
        CHECK(validator.accepts(parse(read_file(file))));
    }
}

TEST_CASE("the schema refuses what the reader refuses by kind, range or name of a key") {
    const Value schema = parse(scenario_schema());
    const Validator validator(schema);
    const auto refuses = [&](const std::string& path, const std::string& value) {
        Value changed = parse(test::small_scenario);
        changed.set(path, parse(value));
        CHECK_FALSE(validator.accepts(changed));
        CHECK_THROWS_AS(read_scenario_text(to_json(changed), "", ""), InputError);
    };
    refuses("colour", "red");
    refuses("gravity", "[0, -9.81, 0]");
    refuses("gravity", "down");
    refuses("materials", "{rock: {density: -1}}");
    refuses("materials", "{rock: {}}");
    refuses("run", "{until: {}}");
    refuses("run", "{until: {time: 1}, solver: magic}");
    refuses("run", "{until: {time: 1}, threads: 1.5}");
    refuses("blocks", "[{outline: [[0, 0], [1, 0], [1, 1]], rectangle: {corner: [0, 0], size: [1, 1]}}]");
    refuses("record", "{frames: {every: 1, count: 2}}");
    refuses("expect", "[{quantity: height, above: 1}]");
}

TEST_CASE("every scenario that comes with the program passes the reader") {
    for (const auto& file : scenario_files()) {
        INFO(file.string());
        CHECK_NOTHROW(read_cases(file.string()));
    }
}

TEST_CASE("every key and shape has a meaning in the reference") {
    const std::string tables = scenario_reference_tables();
    for (const spec::Key& key : spec::scenario().keys) {
        CHECK_FALSE(key.meaning.empty());
        CHECK(tables.find("| `" + key.name + "` |") != std::string::npos);
    }
    CHECK(tables.find("### joint set\n") != std::string::npos);
    CHECK(tables.find("| `loop_area` | J/m2 |") != std::string::npos);
}
