#include "scenario/value.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <limits>
#include <utility>

namespace talus {
namespace {

std::size_t skip_digits(const std::string& text, std::size_t i) {
    while (i < text.size() && text[i] >= '0' && text[i] <= '9') ++i;
    return i;
}

// [-+]? ( \. [0-9]+ | [0-9]+ ( \. [0-9]* )? ) ( [eE] [-+]? [0-9]+ )?     YAML 1.2.2, 10.3.2
bool looks_like_number(const std::string& text) {
    std::size_t i = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
    const std::size_t whole = skip_digits(text, i) - i;
    i += whole;
    if (i < text.size() && text[i] == '.') {
        const std::size_t end = skip_digits(text, ++i);
        if (whole == 0 && end == i) return false;
        i = end;
    } else if (whole == 0) {
        return false;
    }
    if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
        ++i;
        if (i < text.size() && (text[i] == '-' || text[i] == '+')) ++i;
        const std::size_t end = skip_digits(text, i);
        if (end == i) return false;
        i = end;
    }
    return i == text.size();
}

std::string json_text(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            out += '\\', out += c;
        } else if (c == '\n') {
            out += "\\n";
        } else if (static_cast<unsigned char>(c) < 0x20) {
            char code[8];
            std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(c));
            out += code;
        } else {
            out += c;
        }
    }
    return out + '"';
}

std::string json_number(double number) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.17g", number == 0.0 ? 0.0 : number);  // -0 and 0 are the same scene
    return digits;
}

std::string json_raw(const Value& value) {
    if (value.is_null()) return "null";
    if (value.quoted) return json_text(value.text);
    if (const auto number = as_number(value.text)) return json_number(*number);
    if (const auto boolean = as_boolean(value.text)) return *boolean ? "true" : "false";
    return json_text(value.text);
}

std::string json_list(const Value& value) {
    std::string out = "[";
    for (const Value& item : value.items) {
        if (out.size() > 1) out += ',';
        out += to_json(item);
    }
    return out + "]";
}

std::string json_map(const Value& value) {
    std::vector<const Entry*> sorted;
    for (const Entry& entry : value.entries) sorted.push_back(&entry);
    if (!value.of_names)
        std::sort(sorted.begin(), sorted.end(), [](const Entry* a, const Entry* b) { return a->key < b->key; });
    std::string out = "{";
    for (const Entry* entry : sorted) {
        if (out.size() > 1) out += ',';
        out += json_text(entry->key) + ":" + to_json(entry->value);
    }
    return out + "}";
}

}  // namespace

bool Value::is_null() const {
    return kind == Kind::none || (kind == Kind::raw && !quoted &&
                                  (text.empty() || text == "~" || text == "null" || text == "Null" || text == "NULL"));
}

const Value* Value::find(std::string_view key) const {
    for (const Entry& entry : entries)
        if (entry.key == key) return &entry.value;
    return nullptr;
}

Value* Value::find(std::string_view key) { return const_cast<Value*>(std::as_const(*this).find(key)); }

Value& Value::set(const std::string& key, Value value, int key_line) {
    if (Value* old = find(key)) return *old = std::move(value);
    return entries.emplace_back(Entry{key, key_line, std::move(value)}).value;
}

void Value::erase(std::string_view key) {
    std::erase_if(entries, [&](const Entry& entry) { return entry.key == key; });
}

Value Value::of_text(std::string text) {
    Value value;
    value.kind = Kind::raw;
    value.quoted = true;
    value.text = std::move(text);
    return value;
}

Value Value::of_number(double number) {
    Value value;
    value.kind = Kind::raw;
    value.text = json_number(number);
    return value;
}

Value Value::of_list(std::vector<Value> items) {
    Value value;
    value.kind = Kind::list;
    value.items = std::move(items);
    return value;
}

Value Value::of_map() {
    Value value;
    value.kind = Kind::map;
    return value;
}

std::optional<double> as_number(const std::string& text) {
    if (!looks_like_number(text)) return {};
    const char* begin = text.c_str() + (text[0] == '+' ? 1 : 0);
    double number = 0.0;
    const auto [end, error] = std::from_chars(begin, text.c_str() + text.size(), number);
    if (error != std::errc::result_out_of_range) return number;
    // Out of range is too large or too small; what has a negative exponent is too small, and zero for every purpose.
    return text.find("e-") != text.npos || text.find("E-") != text.npos ? 0.0 : std::numeric_limits<double>::infinity();
}

std::optional<bool> as_boolean(const std::string& text) {
    if (text == "true" || text == "True" || text == "TRUE") return true;
    if (text == "false" || text == "False" || text == "FALSE") return false;
    return {};
}

std::string to_json(const Value& value) {
    switch (value.kind) {
        case Value::Kind::none:
            return "null";
        case Value::Kind::raw:
            return json_raw(value);
        case Value::Kind::number:
            return json_number(value.number);
        case Value::Kind::boolean:
            return value.number != 0.0 ? "true" : "false";
        case Value::Kind::text:
            return json_text(value.text);
        case Value::Kind::list:
            return json_list(value);
        case Value::Kind::map:
            break;
    }
    return json_map(value);
}

}  // namespace talus
