// The ends of all boxes along one axis, in order, made for speed: a list that kept its order is only looked through, in
// vector registers, and threads can share a list by chunks.
#pragma once

#include "core/types.hpp"

#include <cstdint>

namespace talus {

/// What the repair of a list, or of one chunk of it, has met.
struct Crossings {
    std::vector<Pair> begun, ended;             // a < b; overlaps that may be new, or may be gone; may hold a pair twice
    std::int64_t exchanges = 0, crossings = 0;  // of any two ends; of a lower and an upper one

    void clear() { begun.clear(), ended.clear(), exchanges = crossings = 0, noted = 0; }

    // room for the repair itself
    struct Crossing {
        int passed, moving;  // tags
    };
    std::vector<Crossing> crossed;  // the first `noted` of them
    std::size_t noted = 0;
};

class EndOrder {
public:
    enum class Axis { x, y };

    explicit EndOrder(Axis axis) : axis_(axis) {}

    /// Lists both ends of every box that is present. O(N)
    void build(std::span<const Box> boxes);

    /// The ends in order, as 2 box, + 1 for an upper one; at equal coordinates lower ends come first, then smaller boxes
    /// (see SortedEnds for why).
    std::span<const int> tags() const { return tag_; }
    int size() const { return static_cast<int>(tag_.size()); }

    /// Puts the ends at the places [from, to) in order among themselves, for new coordinates of the same boxes. False when
    /// a box is met that is not present any more, or when that is more work than building anew; the order is then lost.
    /// Chunks that share no place may be repaired at the same time.
    bool repair(std::span<const Box> boxes, int from, int to, Crossings& met);

    /// Puts in order the places [0, to) when [0, at) and [at, to) are. Whatever the chunks, every two ends that changed
    /// places between two calls are exchanged once in all. False as above.
    bool join(std::span<const Box> boxes, int at, int to, Crossings& met);

    /// Whether so many exchanges, some of them crossings of a lower and an upper end, are less work than building anew.
    bool worth_it(std::int64_t exchanges, std::int64_t crossings) const;

private:
    /// The work, in plain exchanges per box, after which building anew is the better half of a bad bargain: boxes that all
    /// jump cost 1.55 times a build, at 1e4 boxes. With half of it 1.4 times, but then 1e5 blocks of rubble in fast motion
    /// would be built anew at twice the cost of repair. A crossing looks at two boxes that lie anywhere in memory.
    static constexpr std::int64_t worth_repairing = 100, crossing_cost = 10;

    enum class Sunk { no, yes, lost };
    Sunk sink(const double* coordinate, int place, int lowest, Crossings& met);
    void sort_out(std::span<const Box> boxes, Crossings& met) const;
    const double* coordinates(std::span<const Box> boxes) const;

    Axis axis_;
    std::vector<int> tag_;  // [2 number of boxes present]
};

}  // namespace talus
