// The ends of all boxes along one axis, in order: what the textbook methods that sort keep between calls.
#pragma once

#include "contact/search.hpp"

#include <cstdint>

namespace talus {

struct End {
    double at;  // m
    int box;
    bool upper;  // xmax or ymax
};

/// A total order, because blocks cut from rock share corners and exact ties are the normal case: at the same coordinate
/// every lower end comes before every upper end, so that "lower i before upper j, and lower j before upper i" says the same
/// as the closed comparison of coordinates. With any other rule for ties pairs that came apart would stay in the list.
inline bool operator<(const End& a, const End& b) {
    if (a.at != b.at) return a.at < b.at;
    if (a.upper != b.upper) return b.upper;
    return a.box < b.box;
}

class SortedEnds {
public:
    /// The work of one crossing, in plain exchanges: it looks at two boxes that lie anywhere in memory.
    static constexpr std::int64_t crossing_cost = 10;

    /// The work, in plain exchanges, after which the list is built anew: boxes that all jump then cost 1.9 times a build, at
    /// 1e4 boxes. Half of it would be faster for them; but what is published repairs, and columns of a regular grid, which
    /// share one coordinate and are shuffled by rounding, are to be measured as it does them.
    static std::int64_t worth_repairing(std::size_t boxes) { return 250 * static_cast<std::int64_t>(boxes); }

    SortedEnds(double Box::*lower, double Box::*upper) : lower_(lower), upper_(upper) {}

    std::size_t size() const { return ends_.size(); }
    const End& operator[](std::size_t rank) const { return ends_[rank]; }

    /// The ends in order, as 2 box, + 1 for an upper one.
    std::vector<int> tags() const;

    /// How often two ends changed places, in all repairs that came to their end.
    std::int64_t exchanges() const { return exchanges_; }

    /// Along this axis. One branch, not two: which of two boxes lies lower is a coin toss that no processor can predict.
    bool overlap(const Box& a, const Box& b) const { return (a.*lower_ <= b.*upper_) & (b.*lower_ <= a.*upper_); }

    /// Lists both ends of every box that is present.
    void build(std::span<const Box> boxes);

    /// Whether the boxes present are those of the last build.
    bool lists_the_same(std::span<const Box> boxes) const;

    /// Repairs the order, or builds it anew where that is not possible or not worth it.
    void bring_up_to_date(std::span<const Box> boxes) {
        if (!lists_the_same(boxes) || !repair(boxes, [](const End&, const End&) {})) build(boxes);
    }

    /// Takes the new coordinates of the same boxes and repairs the order. Ends that change places are exchanged one step at
    /// a time, each pair of them once; `crossed(passed, moving)` hears of each exchange of a lower with an upper end of two
    /// boxes, the moving one being lower from now on. False when that is more work than it is worth; the list is then left
    /// unsorted, to be built anew: a list that nearly keeps its order costs one comparison per end, a shuffled one O(N^2).
    template <class Crossed>
    bool repair(std::span<const Box> boxes, Crossed&& crossed) {
        std::int64_t exchanges = 0, crossings = 0;
        const std::int64_t limit = worth_repairing(boxes.size());
        for (std::size_t i = 0; i < ends_.size(); ++i) {
            End moving = ends_[i];
            moving.at = coordinate(boxes, moving);
            std::size_t j = i;
            for (; j > 0 && moving < ends_[j - 1]; --j) {
                const End& passed = ends_[j] = ends_[j - 1];
                if (passed.upper == moving.upper) continue;
                crossed(passed, moving);
                ++crossings;
            }
            ends_[j] = moving;
            exchanges += static_cast<std::int64_t>(i - j);
            if (exchanges + crossing_cost * crossings > limit) return false;
        }
        exchanges_ += exchanges;
        return true;
    }

private:
    double coordinate(std::span<const Box> boxes, const End& end) const {
        return boxes[end.box].*(end.upper ? upper_ : lower_);
    }

    double Box::*lower_;
    double Box::*upper_;
    std::vector<End> ends_;
    std::vector<char> listed_;  // [number of boxes] 1 = present when built
    std::int64_t exchanges_ = 0;
};

}  // namespace talus
