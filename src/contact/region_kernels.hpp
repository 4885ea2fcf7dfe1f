// What safe regions do with every box at every step: two loops, in the widest vector registers there are.
#pragma once

#include "core/types.hpp"

#include <cstdint>
#include <vector>

namespace talus {

/// Safe regions of boxes, in single precision: 20 bytes a box are read at every step.
struct Regions {
    std::vector<float> at;      // [4 n] xmin, ymin, xmax, ymax of the reference, m from the centre of the scene
    std::vector<float> radius;  // [n] m; negative: never inside
};

/// Every box of which a bound is further than the radius from that of its reference, or is not a number; in order.
void find_escaped(std::span<const Box> boxes, const Vec2& centre, const Regions& regions, std::vector<int>& escaped);

/// Pairs of which all bounds are compared.
struct WatchedPairs {
    std::vector<std::uint32_t> box, other;  // [pairs] the highest bit of `other` says whether they overlap
    static constexpr std::uint32_t flag = 1u << 31;

    int first(std::size_t k) const { return static_cast<int>(box[k]); }
    int second(std::size_t k) const { return static_cast<int>(other[k] & ~flag); }
    bool overlaps(std::size_t k) const { return (other[k] & flag) != 0; }
};

void compare_watched(std::span<const Box> boxes, WatchedPairs& pairs);

/// Pairs that hang on one inequality: the upper bound of one box against the lower bound of another. A box watches one other
/// beyond each of its two upper bounds.
struct UpperBounds {
    struct Beyond {
        int x, y;  // the other box; the box itself: none
    };
    struct Reaches {
        bool x, y;  // whether the upper bound is not below the lower one of the other
    };
    std::vector<Beyond> beyond;           // [n]
    std::vector<Reaches> reaches;         // [n]
    std::vector<std::uint64_t> watching;  // a bit for every box that watches another, 64 boxes a word; or did
};

/// Compares boxes 64 x word to 64 x word + 63 with those beyond their upper bounds.
void compare_upper_bounds(std::span<const Box> boxes, int word, UpperBounds& bounds);

}  // namespace talus
