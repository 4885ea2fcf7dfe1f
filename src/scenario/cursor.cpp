#include "scenario/cursor.hpp"

#include "scenario/check.hpp"
#include "scenario/nearest.hpp"

#include <algorithm>

namespace talus {
namespace {

const Value absent;

}  // namespace

Cursor Cursor::operator[](const std::string& key) const {
    const std::string path = path_.empty() ? key : path_ + "." + key;
    for (const Entry& entry : value_->entries)
        if (entry.key == key) return {entry.value, path, entry.line, *reading_};
    return {absent, path, line_, *reading_};
}

std::vector<Cursor> Cursor::items() const {
    std::vector<Cursor> all;
    for (std::size_t i = 0; i < value_->items.size(); ++i) {
        const Value& item = value_->items[i];
        if (!item.is(Value::Kind::none)) all.emplace_back(item, path_ + "[" + std::to_string(i) + "]", item.line, *reading_);
    }
    return all;
}

std::vector<std::pair<std::string, Cursor>> Cursor::names() const {
    std::vector<std::pair<std::string, Cursor>> all;
    for (const Entry& entry : value_->entries)
        if (!entry.value.is(Value::Kind::none)) all.emplace_back(entry.key, (*this)[entry.key]);
    return all;
}

std::optional<double> Cursor::maybe_number() const {
    return is(Value::Kind::number) ? std::optional(value_->number) : std::nullopt;
}

std::vector<double> Cursor::numbers() const {
    std::vector<double> all;
    for (const Value& item : value_->items) all.push_back(item.number);
    return all;
}

Vec2 Cursor::vector() const {
    return value_->items.size() == 2 ? Vec2(value_->items[0].number, value_->items[1].number) : Vec2(Vec2::Zero());
}

std::optional<Vec2> Cursor::maybe_point() const { return given() ? std::optional<Vec2>(point()) : std::nullopt; }

std::vector<Vec2> Cursor::points() const {
    std::vector<Vec2> all;
    for (const Cursor& item : items()) all.push_back(item.point());
    return all;
}

TimeTable Cursor::column(const std::string& key) const {
    TimeTable table{(*this)["time"].numbers(), (*this)[key].numbers()};
    if (table.time.empty() || table.value.empty()) return {};  // refused before
    if (table.time.size() != table.value.size()) {
        (*this)[key].fault("has " + std::to_string(table.value.size()) + " values for " + std::to_string(table.time.size()) +
                           " times");
        return {};
    }
    return table;
}

TimeTable Cursor::time_table() const {
    if (is(Value::Kind::number)) return TimeTable::constant(number());
    if (!given()) return {};
    const std::vector<double> time = (*this)["time"].numbers();
    if (!std::is_sorted(time.begin(), time.end(), std::less_equal<>())) (*this)["time"].fault("times must increase");
    return column("value");
}

VectorTable Cursor::vector_table() const {
    if (is(Value::Kind::list)) return {TimeTable::constant(vector().x()), TimeTable::constant(vector().y())};
    if (!given()) return {};
    const std::vector<double> time = (*this)["time"].numbers();
    if (!std::is_sorted(time.begin(), time.end(), std::less_equal<>())) (*this)["time"].fault("times must increase");
    return {column("x"), column("y")};
}

std::string Cursor::name_of(const std::string& kind, const std::vector<std::string>& known) const {
    if (given() && std::find(known.begin(), known.end(), text()) == known.end())
        fault("there is no " + kind + " " + text() + hint(text(), known));
    return text();
}

void Cursor::fault(const std::string& message) const { reading_->faults.push_back({where(), path_, message}); }

Where Cursor::where() const { return place_of(reading_->file, line_); }

}  // namespace talus
