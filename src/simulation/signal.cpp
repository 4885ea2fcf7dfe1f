#include "simulation/signal.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numeric>

namespace talus {
namespace {

constexpr double not_measurable = std::numeric_limits<double>::quiet_NaN();

std::size_t nearest_sample(const Signal& s, double time) {
    const auto after = std::lower_bound(s.time.begin(), s.time.end(), time);
    if (after == s.time.begin()) return 0;
    if (after == s.time.end()) return s.time.size() - 1;
    const auto i = static_cast<std::size_t>(after - s.time.begin());
    return time - s.time[i - 1] < s.time[i] - time ? i - 1 : i;
}

/// A sum of times comes out a few roundings beside the time that was asked for.
bool reaches(const Signal& s, double time) {
    const double rounding = 1e-9 * std::max(std::abs(time), s.time.empty() ? 0.0 : s.time.back());
    return !s.time.empty() && s.time.front() <= time + rounding && time - rounding <= s.time.back();
}

/// Sample before each upward crossing of the mean over time.
std::vector<std::size_t> upward_crossings(const Signal& s) {
    std::vector<std::size_t> crossings;
    if (s.value.empty()) return crossings;
    const double mean = std::accumulate(s.value.begin(), s.value.end(), 0.0) / static_cast<double>(s.value.size());
    for (std::size_t i = 0; i + 1 < s.value.size(); ++i)
        if (s.value[i] < mean && s.value[i + 1] >= mean) crossings.push_back(i);
    return crossings;
}

/// Extreme of the parabola through samples i - 1, i, i + 1 (nearly equal steps).
double parabola_extreme(const std::vector<double>& v, std::size_t i) {
    const double slope = 0.5 * (v[i + 1] - v[i - 1]), curvature = v[i + 1] - 2.0 * v[i] + v[i - 1];
    return curvature == 0.0 ? v[i] : v[i] - 0.5 * slope * slope / curvature;
}

/// s, of that extreme.
double time_of_extreme(const Signal& s, std::size_t i) {
    const double slope = 0.5 * (s.value[i + 1] - s.value[i - 1]);
    const double curvature = s.value[i + 1] - 2.0 * s.value[i] + s.value[i - 1];
    const double share = curvature == 0.0 ? 0.0 : std::clamp(-slope / curvature, -1.0, 1.0);
    return s.time[i] + share * 0.5 * (s.time[i + 1] - s.time[i - 1]);
}

/// Drops from each maximum to the minimum after it.
std::vector<double> swings(const std::vector<double>& v) {
    std::vector<double> drops;
    double top = not_measurable;
    for (std::size_t i = 1; i + 1 < v.size(); ++i) {
        if (v[i - 1] < v[i] && v[i] >= v[i + 1]) top = parabola_extreme(v, i);
        if (v[i - 1] > v[i] && v[i] <= v[i + 1] && !std::isnan(top)) {
            drops.push_back(top - parabola_extreme(v, i));
            top = not_measurable;
        }
    }
    return drops;
}

}  // namespace

Signal between(const Signal& s, double first, double last) {
    const auto from = std::lower_bound(s.time.begin(), s.time.end(), first) - s.time.begin();
    const auto to = std::max(from, std::upper_bound(s.time.begin(), s.time.end(), last) - s.time.begin());
    return {{s.time.begin() + from, s.time.begin() + to}, {s.value.begin() + from, s.value.begin() + to}};
}

double value_at(const Signal& s, double time) {
    if (!reaches(s, time)) return not_measurable;
    const auto after = std::upper_bound(s.time.begin(), s.time.end(), time);
    if (after == s.time.begin()) return s.value.front();
    if (after == s.time.end()) return s.value.back();
    const auto i = static_cast<std::size_t>(after - s.time.begin());
    return std::lerp(s.value[i - 1], s.value[i], (time - s.time[i - 1]) / (s.time[i] - s.time[i - 1]));
}

double mean_rate(const Signal& s, double first, double last) {
    if (!reaches(s, first) || !reaches(s, last)) return not_measurable;
    const std::size_t i = nearest_sample(s, first), j = nearest_sample(s, last);
    return i == j ? not_measurable : (s.value[j] - s.value[i]) / (s.time[j] - s.time[i]);
}

// The mean of an oscillation that dies away is not its level at rest, and the crossings of any other level are uneven; its
// maxima are even.
double frequency(const Signal& s) {
    std::vector<std::size_t> starts = upward_crossings(s), tops;
    if (starts.empty()) return not_measurable;
    starts.insert(starts.begin(), 0);
    starts.push_back(s.value.size() - 1);
    for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
        const auto top = std::max_element(s.value.begin() + starts[k], s.value.begin() + starts[k + 1]);
        const auto i = static_cast<std::size_t>(top - s.value.begin());
        if (i > starts[k] && s.value[i] > s.value[i + 1]) tops.push_back(i);  // not on its way down or up at an end
    }
    if (tops.size() < 2) return not_measurable;
    return static_cast<double>(tops.size() - 1) / (time_of_extreme(s, tops.back()) - time_of_extreme(s, tops.front()));
}

double decrement(const Signal& s) {
    auto drops = swings(s.value);
    if (drops.empty()) return not_measurable;
    const double rest = 1e-4 * *std::max_element(drops.begin(), drops.end());
    drops.erase(std::find_if(drops.begin(), drops.end(), [rest](double d) { return d < rest; }), drops.end());
    return drops.size() < 2 ? not_measurable
                            : std::log(drops.front() / drops.back()) / static_cast<double>(drops.size() - 1);
}

double loop_area(const Signal& x, const Signal& y) {
    const auto crossings = upward_crossings(x);
    if (crossings.size() < 2 || x.time != y.time) return not_measurable;
    // The two ends lie at the same x up to one step; the chord that closes the loop is part of the polygon.
    const std::size_t first = crossings[crossings.size() - 2], last = crossings.back();
    double area = 0.5 * (y.value[last] + y.value[first]) * (x.value[first] - x.value[last]);
    for (std::size_t i = first; i < last; ++i) area += 0.5 * (y.value[i] + y.value[i + 1]) * (x.value[i + 1] - x.value[i]);
    return std::abs(area);
}

}  // namespace talus
