#include "scenario/shape.hpp"

#include "core/text.hpp"
#include "scenario/nearest.hpp"

#include <cmath>

namespace talus::spec {
namespace {

Shape plain(Shape::Kind kind) {
    Shape shape;
    shape.kind = kind;
    return shape;
}

Shape around(Shape::Kind kind, std::vector<Shape> of) {
    Shape shape = plain(kind);
    shape.of = std::move(of);
    return shape;
}

std::string with_unit(const Shape& shape, const std::string& noun) {
    return noun + (shape.unit.empty() || shape.unit == "1" ? "" : " (" + shape.unit + ")");
}

std::string list_text(const Shape& shape) {
    const Shape& item = shape.of.front();
    if (shape.least == shape.most) {
        const std::string count = std::to_string(shape.least);
        if (item.kind == Shape::Kind::number) return with_unit(item, "list of " + count + " numbers");
        return "list of " + count + ": " + item.text();
    }
    std::string size;
    if (shape.least > 0) size = ", at least " + std::to_string(shape.least);
    if (shape.most != Shape::unlimited) size += ", at most " + std::to_string(shape.most);
    return "list of: " + item.text() + size;
}

}  // namespace

std::string Range::text() const {
    const bool below = std::isfinite(low), above = std::isfinite(high);
    if (below && above)
        return talus::number(low) + (open_low ? " (excluded)" : "") + " to " + talus::number(high) +
               (open_high ? " (excluded)" : "");
    if (below) return (open_low ? "> " : ">= ") + talus::number(low);
    if (above) return (open_high ? "< " : "<= ") + talus::number(high);
    return "";
}

const Key* Shape::find(const std::string& name) const {
    for (const Key& key : keys)
        if (key.name == name) return &key;
    return nullptr;
}

std::vector<std::string> Shape::key_names() const {
    std::vector<std::string> names;
    for (const Key& key : keys) names.push_back(key.name);
    return names;
}

std::string Shape::text() const {
    if (!title.empty()) return title;
    const std::string bounds = range.text().empty() ? "" : ", " + range.text();
    switch (kind) {
        case Kind::number:
            return with_unit(*this, "number") + bounds;
        case Kind::integer:
            return "whole number" + bounds;
        case Kind::text:
            return "text";
        case Kind::boolean:
            return "true or false";
        case Kind::choice:
            return enumerate(words, " | ");
        case Kind::list:
            return list_text(*this);
        case Kind::table:
            return "table";
        case Kind::names:
            return "table of NAME: " + of.front().text();
        case Kind::anything:
            return "any value";
        case Kind::either:
            break;
    }
    std::string all;
    for (const Shape& shape : of) all += (all.empty() ? "" : " or ") + shape.text();
    return all;
}

Shape number(const std::string& unit, Range range) {
    Shape shape = plain(Shape::Kind::number);
    shape.unit = unit;
    shape.range = range;
    return shape;
}

Shape integer(Range range) {
    Shape shape = plain(Shape::Kind::integer);
    shape.range = range;
    return shape;
}

Shape text() { return plain(Shape::Kind::text); }
Shape boolean() { return plain(Shape::Kind::boolean); }
Shape anything() { return plain(Shape::Kind::anything); }

Shape choice(std::vector<std::string> words, std::vector<std::string> later) {
    Shape shape = plain(Shape::Kind::choice);
    shape.words = std::move(words);
    shape.later = std::move(later);
    return shape;
}

Shape list_of(Shape item, std::size_t least, std::size_t most) {
    Shape shape = around(Shape::Kind::list, {std::move(item)});
    shape.least = least;
    shape.most = most;
    return shape;
}

Shape names_of(Shape item) { return around(Shape::Kind::names, {std::move(item)}); }
Shape either(std::vector<Shape> alternatives) { return around(Shape::Kind::either, std::move(alternatives)); }

Shape table(const std::string& title, const std::string& meaning, std::vector<Key> keys, std::vector<Rule> rules,
            std::vector<std::string> later) {
    Shape shape = titled(title, meaning, plain(Shape::Kind::table));
    shape.keys = std::move(keys);
    shape.rules = std::move(rules);
    shape.later = std::move(later);
    return shape;
}

Shape titled(const std::string& title, const std::string& meaning, Shape shape) {
    shape.title = title;
    shape.meaning = meaning;
    return shape;
}

}  // namespace talus::spec
