#include "core/time_table.hpp"

#include <algorithm>
#include <iterator>

namespace talus {

double TimeTable::operator()(double t) const {
    if (time.empty()) return 0.0;
    if (t <= time.front()) return value.front();
    if (t >= time.back()) return value.back();
    const auto i = std::upper_bound(time.begin(), time.end(), t) - time.begin();
    const double w = (t - time[i - 1]) / (time[i] - time[i - 1]);
    return value[i - 1] + w * (value[i] - value[i - 1]);
}

double TimeTable::mean(double middle, double span) const {
    const double from = middle - 0.5 * span, to = middle + 0.5 * span;
    auto knot = std::upper_bound(time.begin(), time.end(), from);
    if (!(span > 0.0) || knot == time.end() || *knot >= to) return (*this)(middle);  // one straight line
    double sum = 0.0, begin = from;
    const auto add_until = [&](double end) {
        sum += (end - begin) * (*this)(0.5 * (begin + end));
        begin = end;
    };
    for (; knot != time.end() && *knot < to; ++knot) add_until(*knot);
    add_until(to);
    return sum / span;
}

TimeTable operator+(const TimeTable& a, const TimeTable& b) {
    TimeTable sum;
    std::set_union(a.time.begin(), a.time.end(), b.time.begin(), b.time.end(), std::back_inserter(sum.time));
    for (const double t : sum.time) sum.value.push_back(a(t) + b(t));
    return sum;
}

}  // namespace talus
