// A number that depends on time: constant, or linear between given points and constant outside them.
#pragma once

#include <vector>

namespace talus {

struct TimeTable {
    std::vector<double> time;   // [n] s, increasing; empty = constant zero
    std::vector<double> value;  // [n]

    static TimeTable constant(double v) { return {{0.0}, {v}}; }
    double operator()(double t) const;
    /// Over `span` (s) around `middle`: the exact integral over the span, divided by it; the value there for no span.
    double mean(double middle, double span) const;
    bool is_constant() const { return time.size() < 2; }
    TimeTable frozen() const { return constant((*this)(0.0)); }  // at its value at time 0
    TimeTable at_the_end() const { return value.empty() ? *this : constant(value.back()); }
};

TimeTable operator+(const TimeTable& a, const TimeTable& b);

}  // namespace talus
