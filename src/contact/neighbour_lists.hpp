// For every box a list of neighbours, each with two flags, in one pool of memory.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace talus {

/// How a pair is watched, that is, compared at every step.
enum class Watch : std::uint32_t { not_at_all, one_bound, all_bounds };

/// A neighbour: its number and what is known of the pair.
class Neighbour {
public:
    static constexpr int most = 1 << 29;  // boxes

    Neighbour() = default;
    Neighbour(int box, bool overlaps, Watch watch)
        : bits_(static_cast<std::uint32_t>(box) | static_cast<std::uint32_t>(overlaps) << 31 |
                static_cast<std::uint32_t>(watch) << 29) {}
    int box() const { return static_cast<int>(bits_ & (most - 1)); }
    bool overlaps() const { return bits_ >> 31; }
    void set_overlaps(bool on) { bits_ = (bits_ & ~(1u << 31)) | static_cast<std::uint32_t>(on) << 31; }
    Watch watch() const { return static_cast<Watch>((bits_ >> 29) & 3); }

private:
    std::uint32_t bits_ = 0;
};

class NeighbourLists {
public:
    void reset(int n) {
        places_.assign(n, {});
        watching_.assign((n + 63) / 64, 0);
        pool_.clear();
        for (auto& free : free_) free.clear();
    }

    std::span<Neighbour> of(int i) { return {pool_.data() + places_[i].first, places_[i].count}; }
    std::span<const Neighbour> of(int i) const { return {pool_.data() + places_[i].first, places_[i].count}; }

    /// Those that box i watches: the first in its list.
    std::span<Neighbour> watched_by(int i) { return {pool_.data() + places_[i].first, places_[i].watched}; }
    std::span<const Neighbour> watched_by(int i) const { return {pool_.data() + places_[i].first, places_[i].watched}; }

    /// A bit for every box that watches others, 64 boxes a word.
    std::span<const std::uint64_t> watching() const { return watching_; }

    /// The entry of j in the list of i, or null.
    Neighbour* find(int i, int j) {
        for (Neighbour& n : of(i))
            if (n.box() == j) return &n;
        return nullptr;
    }

    /// At the end of the list of i.
    void add(int i, Neighbour neighbour) {
        Place& place = places_[i];
        if (place.count == room(place)) grow(place);
        pool_[place.first + place.count++] = neighbour;
    }

    void remove(int i, int j) {
        if (Neighbour* found = find(i, j)) {
            found = unwatched(i, found);
            *found = pool_[places_[i].first + --places_[i].count];
        }
    }

    /// Sets what box i knows of j; `first`: it is i who compares all bounds of the pair.
    void set(int i, int j, bool overlaps, Watch watch, bool first) {
        Neighbour* found = find(i, j);
        if (!found) return;
        found = unwatched(i, found);
        *found = Neighbour(j, overlaps, watch);
        if (!first) return;
        Place& place = places_[i];
        std::swap(*found, pool_[place.first + place.watched++]);
        watching_[i / 64] |= std::uint64_t{1} << (i % 64);
    }

private:
    struct Place {
        std::uint32_t first = 0, count = 0, watched = 0;
        int size = -1;  // room for 2^size; -1 = for none
    };
    static constexpr int smallest = 3;  // 2^3: blocks cut by two sets of joints have 8 neighbours

    // Moves an entry behind those that are watched; says where it is then.
    Neighbour* unwatched(int i, Neighbour* entry) {
        Place& place = places_[i];
        if (entry >= pool_.data() + place.first + place.watched) return entry;
        Neighbour* last = pool_.data() + place.first + --place.watched;
        std::swap(*entry, *last);
        if (place.watched == 0) watching_[i / 64] &= ~(std::uint64_t{1} << (i % 64));
        return last;
    }

    static std::uint32_t room(const Place& place) { return place.size < 0 ? 0 : 1u << place.size; }

    void grow(Place& place) {
        const Place old = place;
        place.size = old.size < 0 ? smallest : old.size + 1;
        auto& free = free_[place.size];
        if (free.empty()) {
            place.first = static_cast<std::uint32_t>(pool_.size());
            pool_.resize(pool_.size() + room(place));
        } else {
            place.first = free.back();
            free.pop_back();
        }
        for (std::uint32_t k = 0; k < old.count; ++k) pool_[place.first + k] = pool_[old.first + k];
        if (old.size >= 0) free_[old.size].push_back(old.first);
    }

    std::vector<Place> places_;
    std::vector<Neighbour> pool_;
    std::vector<std::uint64_t> watching_;
    std::array<std::vector<std::uint32_t>, 32> free_;  // places given back, by size
};

}  // namespace talus
