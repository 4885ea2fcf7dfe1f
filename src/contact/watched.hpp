// Pairs that are compared at every step: all four bounds of two boxes, or the one that decides.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace talus {

/// Pairs of which all bounds are compared, each kept by one of its two boxes.
class WatchedPairs {
public:
    std::size_t size() const { return box_.size(); }
    int box(std::size_t k) const { return static_cast<int>(box_[k]); }
    int other(std::size_t k) const { return static_cast<int>(other_[k] & ~flag); }
    bool overlaps(std::size_t k) const { return (other_[k] & flag) != 0; }

    void add(int box, int other, bool overlaps) {
        box_.push_back(static_cast<std::uint32_t>(box));
        other_.push_back(static_cast<std::uint32_t>(other) | (overlaps ? flag : 0));
    }

    /// A pair that is there.
    void remove(int box, int other) {
        std::size_t k = 0;
        while (this->box(k) != box || this->other(k) != other) ++k;
        box_[k] = box_.back();
        other_[k] = other_.back();
        box_.pop_back();
        other_.pop_back();
    }

    template <class Drop>
    void remove_if(Drop&& drop) {
        std::size_t kept = 0;
        for (std::size_t k = 0; k < size(); ++k) {
            box_[kept] = box_[k];
            other_[kept] = other_[k];
            kept += !drop(k);
        }
        box_.resize(kept);
        other_.resize(kept);
    }

    /// Without a way out, which makes it a few vector instructions.
    bool holds(int box, int other) const {
        const auto here = static_cast<std::uint32_t>(box), there = static_cast<std::uint32_t>(other);
        std::uint32_t found = 0;
        for (std::size_t k = 0; k < size(); ++k)
            found |= static_cast<std::uint32_t>(box_[k] == here) & static_cast<std::uint32_t>((other_[k] & ~flag) == there);
        return found != 0;
    }

    static constexpr std::uint32_t flag = 1u << 31;  // of `others`: whether the two overlap
    const std::uint32_t* boxes() const { return box_.data(); }
    std::uint32_t* others() { return other_.data(); }

private:
    std::vector<std::uint32_t> box_, other_;  // [pairs]
};

/// Pairs that hang on one inequality: the upper bound of one box against the lower bound of another. A box watches one other
/// beyond each of its two upper bounds. Bound k of (i, j): even numbers are upper bounds of j, odd ones of i; 0 and 1 are
/// along x, 2 and 3 along y.
struct UpperBounds {
    struct Beyond {
        int x, y;  // the other box; the box itself: none
    };
    std::vector<Beyond> beyond;  // [n]
    std::vector<std::uint8_t>
        reaches;  // of four boxes: bits x, y, x, y, ...: the upper bound is not below the other's lower
    std::vector<std::uint64_t> watching;  // a bit for every box that watches another, 64 boxes a word; or did

    void reset(int n) {
        reaches.assign((n + 3) / 4, 0xff);
        beyond.resize(n);
        for (int i = 0; i < n; ++i) beyond[i] = {i, i};
        watching.assign((n + 63) / 64, 0);
    }

    static int bit(int who, int k) { return 2 * (who % 4) + k / 2; }
    static int owner(int i, int j, int k) { return k % 2 == 0 ? j : i; }
    bool free(int i, int j, int k) const {
        const int who = owner(i, j, k);
        return (k < 2 ? beyond[who].x : beyond[who].y) == who;
    }

    /// Which bound of a pair is watched.
    int of(int i, int j) const {
        const Beyond mine = beyond[i], other = beyond[j];
        return other.x == i ? 0 : mine.x == j ? 1 : other.y == i ? 2 : 3;
    }

    bool overlaps(int i, int j) const {
        const int k = of(i, j), who = owner(i, j, k);
        return reaches[who / 4] >> bit(who, k) & 1;
    }

    void watch(int i, int j, int k, bool overlaps) {
        const int who = owner(i, j, k);
        (k < 2 ? beyond[who].x : beyond[who].y) = i + j - who;
        const unsigned others = reaches[who / 4] & ~(1u << bit(who, k));
        reaches[who / 4] = static_cast<std::uint8_t>(others | static_cast<unsigned>(overlaps) << bit(who, k));
        watching[who / 64] |= std::uint64_t{1} << (who % 64);
    }

    void forget(int i, int j) {
        Beyond &mine = beyond[i], &other = beyond[j];
        if (mine.x == j) mine.x = i;
        if (mine.y == j) mine.y = i;
        if (other.x == i) other.x = j;
        if (other.y == i) other.y = j;
    }
};

}  // namespace talus
