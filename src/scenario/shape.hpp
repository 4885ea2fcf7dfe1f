// What a value of the scenario file may be. The specification (specification.hpp) is one tree of shapes; the reader, the
// JSON Schema and the tables of the reference are all made from it.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace talus::spec {

struct Range {  // of numbers; open ends do not belong to it
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
    bool open_low = false, open_high = false;

    bool contains(double x) const { return (open_low ? x > low : x >= low) && (open_high ? x < high : x <= high); }
    std::string text() const;  // "> 0", "0 to 90 (excluded)"; empty: any number
};
inline constexpr Range positive{0.0, std::numeric_limits<double>::infinity(), true, false};
inline constexpr Range not_negative{0.0};

struct Rule {  // how many of these keys a table wants
    enum class Count { exactly_one, at_least_one, at_most_one };
    Count count;
    std::vector<std::string> keys;
};

struct Key;

struct Shape {
    enum class Kind { number, integer, text, boolean, choice, list, table, names, either, anything };
    static constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();

    Kind kind = Kind::anything;
    std::string title;                        // shapes with a title are described once, in a section of their own
    std::string meaning;                      // of a shape with a title
    std::string unit;                         // number; "1": a pure number
    Range range;                              // number, integer
    std::vector<std::string> words;           // choice
    std::vector<std::string> later;           // choice: words, table: keys that the program will know one day
    std::size_t least = 0, most = unlimited;  // list
    std::vector<Shape> of;                    // list, names: the one shape of the items; either: the alternatives
    std::vector<Key> keys;                    // table
    std::vector<Rule> rules;                  // table

    const Key* find(const std::string& key) const;
    std::vector<std::string> key_names() const;
    std::string text() const;  // "number (Pa), > 0", "list of 2 numbers (m)", "auto or number (s)"
};

struct Presence {  // what happens when a key is absent
    bool required = false;
    std::string value;  // YAML text filled in
    std::string words;  // default in words, where it depends on other keys
};
inline const Presence required{true, {}, {}};
inline const Presence optional{};
inline Presence fallback(const std::string& yaml) { return {false, yaml, {}}; }
inline Presence derived(const std::string& words) { return {false, {}, words}; }

struct Key {
    std::string name;
    Shape shape;
    Presence presence;
    std::string meaning;
};

Shape number(const std::string& unit = "", Range range = {});
Shape integer(Range range);
Shape text();
Shape boolean();
Shape anything();
Shape choice(std::vector<std::string> words, std::vector<std::string> later = {});
Shape list_of(Shape item, std::size_t least = 0, std::size_t most = Shape::unlimited);
Shape names_of(Shape item);  // map NAME: item
Shape either(std::vector<Shape> alternatives);
Shape table(const std::string& title, const std::string& meaning, std::vector<Key> keys, std::vector<Rule> rules = {},
            std::vector<std::string> later = {});
Shape titled(const std::string& title, const std::string& meaning, Shape shape);

}  // namespace talus::spec
