#include "model/trace_lines.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

namespace talus {
namespace {

using Polyline = std::vector<Vec2>;

/// Moves points onto the nearest earlier point closer than `distance`, found in a grid of cells of that size.
class Snapping {
public:
    explicit Snapping(double distance) : distance_(distance) {}

    Vec2 operator()(const Vec2& p) {
        const auto cell = [&](double x) { return static_cast<std::int64_t>(std::floor(x / distance_)); };
        const std::int64_t i = cell(p.x()), j = cell(p.y());
        const Vec2* nearest = nullptr;
        for (std::int64_t di = -1; di <= 1; ++di)
            for (std::int64_t dj = -1; dj <= 1; ++dj) {
                const auto found = cells_.find({i + di, j + dj});
                if (found == cells_.end()) continue;
                for (const Vec2& q : found->second)
                    if ((q - p).norm() < (nearest ? (*nearest - p).norm() : distance_)) nearest = &q;
            }
        if (nearest) return *nearest;
        cells_[{i, j}].push_back(p);
        return p;
    }

    /// All points that stayed where they were, by x.
    std::vector<Vec2> points() const {
        std::vector<Vec2> all;
        for (const auto& [cell, points] : cells_) all.insert(all.end(), points.begin(), points.end());
        std::stable_sort(all.begin(), all.end(), [](const Vec2& a, const Vec2& b) { return a.x() < b.x(); });
        return all;
    }

private:
    double distance_;
    std::map<std::pair<std::int64_t, std::int64_t>, std::vector<Vec2>> cells_;
};

/// Corners (sorted by x) nearer than `distance` to the segment from a to b, in order along it, its ends left out.
std::vector<Vec2> corners_beside(const Vec2& a, const Vec2& b, double distance, const std::vector<Vec2>& corners) {
    const Vec2 along = (b - a).normalized();
    std::vector<std::pair<double, Vec2>> found;
    const auto by_x = [](const Vec2& p, double x) { return p.x() < x; };
    for (auto p = std::lower_bound(corners.begin(), corners.end(), std::min(a.x(), b.x()) - distance, by_x);
         p != corners.end() && p->x() <= std::max(a.x(), b.x()) + distance; ++p) {
        const double at = along.dot(*p - a);
        if (at > 0.0 && at < (b - a).norm() && std::abs(cross(along, *p - a)) < distance && *p != a && *p != b)
            found.emplace_back(at, *p);
    }
    std::sort(found.begin(), found.end(), [](const auto& p, const auto& q) { return p.first < q.first; });
    std::vector<Vec2> result;
    for (const auto& [at, p] : found) result.push_back(p);
    return result;
}

/// Leads a polyline through the corners it passes. Returns how many there were.
int lead_through(Polyline& points, double distance, const std::vector<Vec2>& corners) {
    Polyline led;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        led.push_back(points[i]);
        for (const Vec2& p : corners_beside(points[i], points[i + 1], distance, corners)) led.push_back(p);
    }
    led.push_back(points.back());
    const int added = static_cast<int>(led.size() - points.size());
    points = std::move(led);
    return added;
}

/// Makes one corner of those that are meant to be one, in all traces.
void join_corners(std::vector<Polyline>& traces, const Polygon& outline, double distance, TraceLines& report) {
    Snapping snapping(distance);
    for (const Vec2& p : outline) snapping(p);
    for (Polyline& points : traces) {
        for (Vec2& p : points) {
            const Vec2 snapped = snapping(p);
            report.corners_snapped += snapped != p;
            p = snapped;
        }
        points.erase(std::unique(points.begin(), points.end()), points.end());
    }
    const std::vector<Vec2> corners = snapping.points();
    for (Polyline& points : traces)  // a bent segment may pass the next corner; more than a few rounds do not happen
        for (int round = 0; round < 5; ++round) {
            const int added = lead_through(points, distance, corners);
            report.junctions += added;
            if (added == 0) break;
        }
}

using Place = std::pair<double, double>;
Place place(const Vec2& p) { return {p.x(), p.y()}; }

struct Visits {  // of all traces to one corner
    int end = 0, pass = 0;
};

std::map<Place, Visits> visits(const std::vector<Polyline>& traces) {
    std::map<Place, Visits> all;
    for (const Polyline& points : traces)
        for (std::size_t i = 0; i < points.size(); ++i)
            ++(i == 0 || i + 1 == points.size() ? all[place(points[i])].end : all[place(points[i])].pass);
    return all;
}

}  // namespace

void add_polyline(std::vector<Vec2> points, double at_first, double at_last, int source, std::vector<CutLine>& lines) {
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 2) return;
    if (points.front() != points.back()) {
        const Vec2 first = (points[0] - points[1]).normalized();
        const Vec2 last = (points.back() - points[points.size() - 2]).normalized();
        // The tip stays a corner: moved outwards, the rounded line could pass beside another one that ends there too.
        if (at_first > 0.0) points.insert(points.begin(), points.front() + at_first * first);
        if (at_last > 0.0) points.push_back(points.back() + at_last * last);
    }
    for (std::size_t i = 0; i + 1 < points.size(); ++i) lines.push_back({points[i], points[i + 1], source});
}

TraceLines trace_lines(const TraceMapSpec& map, const Polygon& outline, double reach, int source) {
    TraceLines result;
    std::vector<Polyline> traces = map.lines;
    if (const double snap = std::max(map.snap, reach); snap > 0.0) join_corners(traces, outline, snap, result);
    const std::map<Place, Visits> all = visits(traces);
    for (const Polyline& points : traces) {
        if (points.size() < 2) continue;
        ++result.traces;
        const auto extension = [&](const Vec2& tip) {
            const auto [end, pass] = all.at(place(tip));
            if (pass > 0) return 0.0;  // meets the other trace in this very corner: further on it would cut a splinter
            const bool extended = end == 1 && map.extend > reach;
            result.tips_extended += extended;
            return extended ? map.extend : reach;
        };
        const double at_first = extension(points.front()), at_last = extension(points.back());
        add_polyline(points, at_first, at_last, source, result.lines);
    }
    return result;
}

}  // namespace talus
