// The pairs that overlap, kept from step to step by the searches that only look at changes.
#pragma once

#include "core/types.hpp"

namespace talus {

/// Numbers in increasing order, each once; the first few take no memory of their own.
class FewIds {
public:
    static constexpr int few = 6;  // a block of rock has 2 or 3 neighbours of larger number on average

    FewIds() = default;
    FewIds(FewIds&& other) noexcept;
    FewIds(const FewIds&) = delete;
    FewIds& operator=(const FewIds&) = delete;
    ~FewIds();

    int size() const { return size_; }
    const int* begin() const { return capacity_ == few ? few_ : many_; }
    const int* end() const { return begin() + size_; }

    /// Writes them as pairs of a, and some that mean nothing behind them, so that the usual case takes no branch; room for
    /// `few` pairs at least. Returns where the next pairs belong.
    Pair* write(int a, Pair* to) const;

    /// No effect if the number is there already.
    void insert(int id);

    /// No effect if the number is not there.
    void erase(int id);

private:
    int below(int id) const;
    int* begin() { return capacity_ == few ? few_ : many_; }
    void grow();

    int size_ = 0, capacity_ = few;
    union {
        int few_[few] = {};
        int* many_;  // owned, when capacity_ > few
    };
};

/// A set of pairs without hashing: each box a owns the numbers b > a of its neighbours. One cache line holds what one box
/// owns, the set is always in order, and threads may change the pairs of different owners at the same time.
class PairSet {
public:
    /// Makes the set anew of pairs that are each given once, in any order.
    void assign(std::size_t boxes, std::span<const Pair> pairs);

    void insert(Pair pair) { larger_[pair.a].insert(pair.b); }
    void erase(Pair pair) { larger_[pair.a].erase(pair.b); }

    /// Writes all pairs, sorted.
    void list(std::vector<Pair>& pairs) const;

private:
    std::vector<FewIds> larger_;  // [number of boxes]
};

/// Sorts pairs of boxes numbered from 0 to `boxes`, less than 2^31 of them, each given once.
void sort_pairs(std::size_t boxes, std::span<const Pair> pairs, std::vector<Pair>& sorted);

}  // namespace talus
