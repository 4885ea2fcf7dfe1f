#include "scenario/check.hpp"

#include "scenario/nearest.hpp"
#include "scenario/yaml_file.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace talus {
namespace {

using Kind = spec::Shape::Kind;

bool is_any_of(const std::string& word, const std::vector<std::string>& words) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

std::string shown(const Value& value) {
    if (value.is(Value::Kind::list)) return "a list";
    if (value.is(Value::Kind::map)) return "a table";
    return '"' + (value.text.size() > 40 ? value.text.substr(0, 37) + "..." : value.text) + '"';
}

// Whether this is the alternative that somebody meant.
bool fits(const Value& value, const spec::Shape& shape) {
    const bool scalar = value.is(Value::Kind::raw);
    switch (shape.kind) {
        case Kind::list:
            return value.is(Value::Kind::list);
        case Kind::table:
        case Kind::names:
            return value.is(Value::Kind::map);
        case Kind::anything:
            return true;
        case Kind::text:
            return scalar;
        case Kind::number:
        case Kind::integer:
            return scalar && !value.quoted && as_number(value.text);
        case Kind::boolean:
            return scalar && !value.quoted && as_boolean(value.text);
        case Kind::choice:
            return scalar && (is_any_of(value.text, shape.words) || is_any_of(value.text, shape.later));
        case Kind::either:
            break;
    }
    return std::any_of(shape.of.begin(), shape.of.end(), [&](const spec::Shape& one) { return fits(value, one); });
}

class Checker {
public:
    Checker(const std::string& file, std::vector<Fault>& faults) : file_(file), faults_(faults) {}

    Value check(const Value& value, const spec::Shape& shape, const std::string& path) {
        if (shape.kind == Kind::anything) return value;
        if (value.is_null()) return refuse(value, path, "has no value; expected " + shape.text());
        switch (shape.kind) {
            case Kind::number:
            case Kind::integer:
                return check_number(value, shape, path);
            case Kind::boolean:
                return check_boolean(value, shape, path);
            case Kind::text:
                return check_text(value, shape, path);
            case Kind::choice:
                return check_choice(value, shape, path);
            case Kind::list:
                return check_list(value, shape, path);
            case Kind::names:
                return check_names(value, shape, path);
            case Kind::table:
                return check_table(value, shape, path);
            default:
                return check_either(value, shape, path);
        }
    }

private:
    void fault(int line, const std::string& path, const std::string& message) {
        faults_.push_back({place_of(file_, line), path, message});
    }

    Value refuse(const Value& value, const std::string& path, const std::string& message) {
        fault(value.line, path, message);
        return {};
    }

    Value refuse_kind(const Value& value, const spec::Shape& shape, const std::string& path) {
        return refuse(value, path, "expected " + shape.text() + ", got " + shown(value));
    }

    static Value typed(const Value& value, Value::Kind kind, double number) {
        Value out = value;
        out.kind = kind;
        out.number = number;
        return out;
    }

    Value check_number(const Value& value, const spec::Shape& shape, const std::string& path) {
        const auto number = value.is(Value::Kind::raw) && !value.quoted ? as_number(value.text) : std::nullopt;
        if (!number) return refuse_kind(value, shape, path);
        if (!std::isfinite(*number)) return refuse(value, path, "is too large for a number: " + shown(value));
        const bool whole = shape.kind != Kind::integer || *number == std::floor(*number);
        if (!whole || !shape.range.contains(*number)) return refuse_kind(value, shape, path);
        return typed(value, Value::Kind::number, *number);
    }

    Value check_boolean(const Value& value, const spec::Shape& shape, const std::string& path) {
        const auto boolean = value.is(Value::Kind::raw) && !value.quoted ? as_boolean(value.text) : std::nullopt;
        return boolean ? typed(value, Value::Kind::boolean, *boolean ? 1.0 : 0.0) : refuse_kind(value, shape, path);
    }

    Value check_text(const Value& value, const spec::Shape& shape, const std::string& path) {
        return value.is(Value::Kind::raw) ? typed(value, Value::Kind::text, 0.0) : refuse_kind(value, shape, path);
    }

    Value check_choice(const Value& value, const spec::Shape& shape, const std::string& path) {
        if (!value.is(Value::Kind::raw)) return refuse_kind(value, shape, path);
        if (is_any_of(value.text, shape.words)) return typed(value, Value::Kind::text, 0.0);
        if (is_any_of(value.text, shape.later)) return refuse(value, path, value.text + " is not available yet");
        const std::string near = nearest(value.text, shape.words);
        const std::string advice = near.empty() ? "" : "; did you mean " + near + "?";
        return refuse(value, path, "expected " + shape.text() + ", got " + shown(value) + advice);
    }

    Value check_list(const Value& value, const spec::Shape& shape, const std::string& path) {
        if (!value.is(Value::Kind::list)) return refuse_kind(value, shape, path);
        const std::size_t n = value.items.size();
        if (n < shape.least || n > shape.most)
            return refuse(value, path,
                          "has " + std::to_string(n) + (n == 1 ? " item" : " items") + "; expected " + list_text(shape));
        Value out = value;
        bool whole = true;
        for (std::size_t i = 0; i < n; ++i) {
            out.items[i] = check(value.items[i], shape.of.front(), path + "[" + std::to_string(i) + "]");
            whole = whole && !out.items[i].is(Value::Kind::none);
        }
        // Half a point or polygon is none; of a list of tables the others still count.
        const spec::Shape& item = shape.of.front();
        const bool needs_all = item.kind == Kind::number || item.kind == Kind::boolean || item.kind == Kind::list;
        return whole || !needs_all ? out : Value{};
    }

    static std::string list_text(spec::Shape shape) {
        if (shape.title.empty() || shape.title == "point") return shape.text();
        const std::string title = shape.title;
        shape.title.clear();
        return title + ": " + shape.text();
    }

    Value check_names(const Value& value, const spec::Shape& shape, const std::string& path) {
        if (!value.is(Value::Kind::map)) return refuse_kind(value, shape, path);
        Value out = value;
        out.of_names = true;
        for (Entry& entry : out.entries) entry.value = check(entry.value, shape.of.front(), path + "." + entry.key);
        return out;
    }

    Value check_either(const Value& value, const spec::Shape& shape, const std::string& path) {
        for (const spec::Shape& alternative : shape.of)
            if (fits(value, alternative)) return check(value, alternative, path);
        return refuse_kind(value, shape, path);
    }

    Value check_table(const Value& value, const spec::Shape& shape, const std::string& path) {
        if (!value.is(Value::Kind::map)) return refuse_kind(value, shape, path);
        const std::string prefix = path.empty() ? "" : path + ".";
        Value out = value;
        out.entries.clear();
        std::set<std::string> meant;  // by words that are no keys: one fault is enough
        for (const Entry& entry : value.entries) {
            const spec::Key* key = shape.find(entry.key);
            meant.insert(key ? entry.key : nearest(entry.key, shape.key_names()));
            if (key)
                out.entries.push_back({entry.key, entry.line, check(entry.value, key->shape, prefix + entry.key)});
            else if (is_any_of(entry.key, shape.later))
                fault(entry.line, prefix + entry.key, "not available yet");
            else
                fault(entry.line, prefix + entry.key, "unknown key" + hint(entry.key, shape.key_names()));
        }
        check_rules(meant, shape, path, value.line);
        for (const spec::Key& key : shape.keys) {
            if (meant.contains(key.name)) continue;
            if (key.presence.required)
                fault(value.line, prefix + key.name, "is missing (" + key.shape.text() + ": " + key.meaning + ")");
            if (!key.presence.value.empty()) {
                const Value filled = with_line(default_value(key.presence.value), value.line);
                out.entries.push_back({key.name, value.line, check(filled, key.shape, prefix + key.name)});
            }
        }
        return out;
    }

    // Thousands of blocks have the same few defaults: each is parsed once.
    const Value& default_value(const std::string& yaml) {
        const auto [at, fresh] = defaults_.try_emplace(yaml);
        if (fresh) at->second = parse_yaml(yaml, "default", faults_);
        return at->second;
    }

    static Value with_line(Value value, int line) {
        value.line = line;
        for (Value& item : value.items) item.line = line;
        return value;
    }

    void check_rules(const std::set<std::string>& given, const spec::Shape& shape, const std::string& path, int line) {
        for (const spec::Rule& rule : shape.rules) {
            const auto count = std::count_if(rule.keys.begin(), rule.keys.end(),
                                             [&](const std::string& key) { return given.contains(key); });
            const std::string keys = enumerate(rule.keys);
            if (rule.count == spec::Rule::Count::exactly_one && count != 1)
                fault(line, path, "needs exactly one of " + keys);
            if (rule.count == spec::Rule::Count::at_least_one && count < 1)
                fault(line, path, "needs at least one of " + keys);
            if (rule.count == spec::Rule::Count::at_most_one && count > 1) fault(line, path, "takes only one of " + keys);
        }
    }

    const std::string& file_;
    std::vector<Fault>& faults_;
    std::map<std::string, Value> defaults_;
};

}  // namespace

Where place_of(const std::string& file, int line) { return line > 0 ? Where{file, line} : Where{"--set", 0}; }

Value check(const Value& value, const spec::Shape& shape, const std::string& path, const std::string& file,
            std::vector<Fault>& faults) {
    return Checker(file, faults).check(value, shape, path);
}

}  // namespace talus
