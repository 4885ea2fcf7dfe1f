#include "geometry/planar_map.hpp"
#include "geometry/polygon.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <queue>
#include <utility>

namespace talus {
namespace {

class Merging {
public:
    Merging(PlanarMap& map, const CutInput& input, CutReport& report) : map_(map), report_(report) {
        const std::size_t faces = map.region.size();
        of_.resize(faces), halves_.resize(faces), area_.resize(faces);
        for (std::size_t f = 0; f < faces; ++f) of_[f] = static_cast<int>(f);
        for (std::size_t h = 0; h < map.half.size(); ++h)
            if (map.half[h].face >= 0) halves_[map.half[h].face].push_back(static_cast<int>(h));
        for (std::size_t f = 0; f < faces; ++f) {
            area_[f] = loop_area(halves_[f]);
            report.outline_area += area_[f];
        }
        set_limits(input);
    }

    std::vector<int> run() {
        for (std::size_t f = 0; f < of_.size(); ++f) consider(static_cast<int>(f));
        while (!slivers_.empty()) {
            const auto [area, sliver] = slivers_.top();
            slivers_.pop();
            if (of_[sliver] == sliver && area == area_[sliver]) merge(sliver);  // otherwise it has grown or gone since
        }
        std::vector<int> of(of_.size());
        for (std::size_t f = 0; f < of.size(); ++f) of[f] = block(static_cast<int>(f));
        return of;
    }

private:
    void set_limits(const CutInput& input) {
        const double mean = area_.empty() ? 0.0 : report_.outline_area / static_cast<double>(area_.size());
        report_.sliver_area = std::max(input.sliver_area, input.sliver_area_share * mean);
        report_.sliver_width =
            std::max({input.sliver_width, input.sliver_width_share * std::sqrt(mean), rounding(map_.point)});
    }

    int block(int face) const {
        while (face >= 0 && of_[face] != face) face = of_[face];
        return face;
    }
    int across(int h) const { return block(map_.half[h ^ 1].face); }

    double loop_area(const std::vector<int>& halves) const {  // edges that run into the face and back add nothing
        double twice = 0.0;
        const Vec2 from = map_.start(halves[0]);
        for (const int h : halves) twice += cross(map_.start(h) - from, map_.end(h) - from);
        return twice / 2.0;
    }

    void consider(int face) {
        double boundary = 0.0;
        for (const int h : halves_[face])
            if (across(h) != face) boundary += map_.length(h);
        if (area_[face] < report_.sliver_area || 2.0 * area_[face] < report_.sliver_width * boundary)
            slivers_.emplace(area_[face], face);
    }

    /// Neighbour of the longest common edge and the source that parts most of it; -1 if there is only the outside.
    std::pair<int, int> best_neighbour(int sliver) const {
        std::map<int, double> common;
        std::map<std::pair<int, int>, double> common_along;
        for (const int h : halves_[sliver]) {
            const int other = across(h);
            if (other < 0 || other == sliver) continue;
            common[other] += map_.length(h);
            common_along[{other, map_.half[h].source}] += map_.length(h);
        }
        const auto longer = [](const auto& a, const auto& b) { return a.second < b.second; };
        const auto best = std::max_element(common.begin(), common.end(), longer);
        if (best == common.end()) return {-1, -1};
        const auto first = common_along.lower_bound({best->first, -1}),
                   last = common_along.lower_bound({best->first + 1, -1});
        return {best->first, std::max_element(first, last, longer)->first.second};
    }

    void merge(int sliver) {
        const auto [neighbour, source] = best_neighbour(sliver);
        if (neighbour < 0) {
            ++report_.dropped;
            report_.dropped_area += area_[sliver];
            of_[sliver] = -1;
            return;
        }
        ++report_.merged;
        report_.merged_area += area_[sliver];
        report_.merged_at.push_back(middle(sliver));
        for (const int h : halves_[sliver])  // a region edge a rounding error beside a joint must not end that joint
            if (map_.half[h].source < 0) map_.half[h].source = map_.half[h ^ 1].source = source;
        of_[sliver] = neighbour;
        area_[neighbour] += area_[sliver];
        halves_[neighbour].insert(halves_[neighbour].end(), halves_[sliver].begin(), halves_[sliver].end());
        halves_[sliver].clear();
        consider(neighbour);
    }

    Vec2 middle(int face) const {
        Vec2 sum = Vec2::Zero();
        for (const int h : halves_[face]) sum += map_.start(h);
        return sum / static_cast<double>(halves_[face].size());
    }

    PlanarMap& map_;
    CutReport& report_;
    std::vector<int> of_;                   // [nf] face it was merged with, itself if none
    std::vector<std::vector<int>> halves_;  // [nf] all edges of the merged faces
    std::vector<double> area_;              // [nf] m2
    using Sliver = std::pair<double, int>;
    std::priority_queue<Sliver, std::vector<Sliver>, std::greater<>> slivers_;
};

}  // namespace

std::vector<int> merge_slivers(PlanarMap& map, const CutInput& limits, CutReport& report) {
    return Merging(map, limits, report).run();
}

}  // namespace talus
