// The ends of all boxes along one axis, in order, made for speed: coordinates and tags apart, so that a list that kept its
// order is brought up to date and looked through in vector registers, and in chunks, so that threads can share a list.
#pragma once

#include "core/types.hpp"

#include <cstdint>

namespace talus {

/// What the repair of a list, or of one chunk of it, has met.
struct Crossings {
    std::vector<Pair> pairs;     // a < b, whose lower and upper end changed places; may hold a pair twice
    std::int64_t exchanges = 0;  // of any two ends

    void clear() { pairs.clear(), exchanges = 0; }
};

class EndOrder {
public:
    enum class Axis { x, y };

    explicit EndOrder(Axis axis) : axis_(axis) {}

    /// Lists both ends of every box that is present. O(N log N)
    void build(std::span<const Box> boxes);

    /// The ends in order, as 2 box, + 1 for an upper one; at equal coordinates lower ends come first, then smaller boxes
    /// (see SortedEnds for why).
    std::span<const int> tags() const { return tag_; }
    std::size_t size() const { return tag_.size(); }

    /// Takes the new coordinates of the ends at the places [from, to) and puts these in order among themselves. False when
    /// a box is met that is not present any more, or when that is more work than building anew; the order is then lost.
    /// Chunks that share no place may be repaired at the same time.
    bool repair(std::span<const Box> boxes, std::size_t from, std::size_t to, Crossings& crossings);

    /// Puts in order the places [0, to) when [0, at) and [at, to) are. Whatever the chunks, every two ends that changed
    /// places between two calls are exchanged once in all. False as above.
    bool join(std::size_t at, std::size_t to, Crossings& crossings);

    /// Whether so many exchanges, some of them crossings of a lower and an upper end, are less work than building anew.
    bool worth_it(std::int64_t exchanges, std::int64_t crossings) const;

private:
    enum class Sunk { no, yes, lost };
    Sunk sink(std::size_t place, std::size_t lowest, Crossings& crossings);

    Axis axis_;
    std::vector<double> at_;  // [2 number of boxes present] m
    std::vector<int> tag_;    // of the same ends
};

}  // namespace talus
