// A place in a checked scenario: its value, its path for faults, and what all places share.
#pragma once

#include "core/errors.hpp"
#include "core/time_table.hpp"
#include "core/types.hpp"
#include "scenario/scenario.hpp"
#include "scenario/value.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace talus {

struct Reading {  // of one file
    std::string file, folder;
    Vec2 origin = Vec2::Zero();  // m, subtracted from every coordinate
    std::vector<Fault> faults;
    std::vector<std::string> materials, joints, regions, blocks;  // names to choose from
};

/// Absent keys give cursors that are not `given`; their numbers are 0, their texts empty, their lists empty. Types have been
/// checked before, so that nothing here can fail.
class Cursor {
public:
    Cursor(const Value& value, std::string path, int line, Reading& reading)
        : value_(&value), path_(std::move(path)), line_(line), reading_(&reading) {}

    bool given() const { return !value_->is(Value::Kind::none); }
    bool is(Value::Kind kind) const { return value_->is(kind); }
    Cursor operator[](const std::string& key) const;
    std::vector<Cursor> items() const;                          // of a list, without those that were refused
    std::vector<std::pair<std::string, Cursor>> names() const;  // of a table of names, likewise

    double number() const { return value_->number; }
    double angle() const { return radians(value_->number); }  // of a key that ends in _deg
    bool yes() const { return value_->number != 0.0; }
    const std::string& text() const { return value_->text; }
    std::optional<double> maybe_number() const;
    std::vector<double> numbers() const;
    Vec2 vector() const;                                        // two numbers as they are
    Vec2 point() const { return vector() - reading_->origin; }  // m
    std::optional<Vec2> maybe_point() const;
    std::vector<Vec2> points() const;
    TimeTable time_table() const;      // a number, or {time, value}
    VectorTable vector_table() const;  // [x, y], or {time, x, y}

    /// The text, which must be one of the names; else a fault with the nearest one. `kind`: material, joint, ...
    std::string name_of(const std::string& kind, const std::vector<std::string>& known) const;
    void fault(const std::string& message) const;
    Where where() const;
    const Value& value() const { return *value_; }
    const std::string& path() const { return path_; }
    Reading& reading() const { return *reading_; }

private:
    TimeTable column(const std::string& key) const;  // of a time table; faults if it is none

    const Value* value_;
    std::string path_;
    int line_;
    Reading* reading_;
};

}  // namespace talus
