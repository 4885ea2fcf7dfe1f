// What a scenario file holds before anyone knows what it means: scalars, lists and maps, each with the line it stands on.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace talus {

struct Entry;

/// A node of the file. As read, every scalar is `raw`; the check against the specification makes numbers, booleans and texts
/// of them, and turns what it has refused into `none`, so that later steps see it as absent.
struct Value {
    enum class Kind { none, raw, number, boolean, text, list, map };
    Kind kind = Kind::none;
    int line = 0;                // 1-based; 0: from the command line or a default
    std::string text;            // raw, text
    bool quoted = false;         // raw: "5" in quotes is a text, 5 a number
    double number = 0.0;         // number; boolean: 0 or 1
    std::vector<Value> items;    // list
    std::vector<Entry> entries;  // map, in the order of the file
    bool of_names = false;       // map: keys are names given by the author, and their order says something

    bool is(Kind k) const { return kind == k; }
    bool is_null() const;  // an empty value, null or ~

    const Value* find(std::string_view key) const;  // map: nullptr when absent; anything else: nullptr
    Value* find(std::string_view key);
    Value& set(const std::string& key, Value value, int key_line = 0);  // adds or replaces
    void erase(std::string_view key);

    static Value of_text(std::string text);
    static Value of_number(double number);
    static Value of_list(std::vector<Value> items);
    static Value of_map();
};

struct Entry {
    std::string key;
    int line = 0;
    Value value;
};

/// Number by the core rules of YAML 1.2: 5, -0.5, .5, 5e9; not 1_000, 0x10, .inf, .nan. Infinite when it does not fit a
/// double.
std::optional<double> as_number(const std::string& text);
std::optional<bool> as_boolean(const std::string& text);  // true, True, TRUE, false, False, FALSE

/// Sorted keys (names in their order), numbers as %.17g, no white space: equal trees give equal texts. Raw scalars get the
/// type YAML gives them.
std::string to_json(const Value& value);

}  // namespace talus
