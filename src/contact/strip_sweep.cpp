#include "contact/strip_sweep.hpp"

#include <algorithm>

namespace talus {
namespace {

/// The strips that a box lies in.
struct Reach {
    int first, last;
};

/// Places the cuts: a new strip begins where the boxes that began in this one are this many times those that the cut would
/// go through. In layers of equal blocks that makes strips of four block heights; whatever the sizes, boxes are listed
/// in their strips at most 1 + 1/4 times each on average. Half of it lists 1.5, twice of it meets 1.8 times as many.
constexpr int strip_height = 4;

std::vector<Reach> cut(std::size_t boxes, std::span<const int> y_ends, int& strips) {
    std::vector<Reach> reach(boxes, {0, -1});
    int strip = 0, begun = 0, open = 0;
    for (const int end : y_ends) {
        if (end % 2 != 0) {
            reach[end / 2].last = strip;
            --open;
            continue;
        }
        if (begun > strip_height * open) ++strip, begun = 0;
        reach[end / 2].first = strip;
        ++begun, ++open;
    }
    strips = strip + 1;
    return reach;
}

/// The boxes of each strip in the order of their lower ends along x: those of strip s are [first[s], first[s + 1]).
struct Strips {
    std::vector<std::size_t> first;
    std::vector<int> box;
};

Strips fill(std::span<const int> x_ends, const std::vector<Reach>& reach, int count) {
    Strips strips;
    strips.first.assign(count + 1, 0);
    for (const Reach& of : reach)
        for (int s = of.first; s <= of.last; ++s) ++strips.first[s + 1];
    for (int s = 0; s < count; ++s) strips.first[s + 1] += strips.first[s];
    strips.box.resize(strips.first[count]);
    std::vector<std::size_t> next = strips.first;
    for (const int end : x_ends)
        if (end % 2 == 0)
            for (int s = reach[end / 2].first; s <= reach[end / 2].last; ++s) strips.box[next[s]++] = end / 2;
    return strips;
}

}  // namespace

std::vector<Pair> strip_sweep(std::span<const Box> boxes, std::span<const int> x_ends, std::span<const int> y_ends) {
    int count = 0;
    const std::vector<Reach> reach = cut(boxes.size(), y_ends, count);
    const Strips strips = fill(x_ends, reach, count);
    std::vector<Pair> pairs;
    for (int s = 0; s < count; ++s)
        for (std::size_t k = strips.first[s]; k < strips.first[s + 1]; ++k) {
            const int i = strips.box[k];
            const Box& mine = boxes[i];
            for (std::size_t m = k + 1; m < strips.first[s + 1]; ++m) {
                const int j = strips.box[m];
                const Box& other = boxes[j];
                if (other.xmin > mine.xmax) break;
                // two boxes may share several strips: the first of them counts
                if ((mine.ymin <= other.ymax) & (other.ymin <= mine.ymax) & (s == std::max(reach[i].first, reach[j].first)))
                    pairs.push_back({std::min(i, j), std::max(i, j)});
            }
        }
    return pairs;
}

}  // namespace talus
