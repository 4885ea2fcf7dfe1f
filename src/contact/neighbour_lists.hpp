// For every box a list of neighbours, each with two flags, in one pool of memory.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
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
    Watch watch() const { return static_cast<Watch>((bits_ >> 29) & 3); }

private:
    std::uint32_t bits_ = 0;
};

class NeighbourLists {
public:
    void reset(int n) {
        places_.assign(n, {});
        pool_.clear();
        for (auto& free : free_) free.clear();
    }

    std::span<Neighbour> of(int i) { return {pool_.data() + places_[i].first, places_[i].count}; }
    std::span<const Neighbour> of(int i) const { return {pool_.data() + places_[i].first, places_[i].count}; }

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
        if (Neighbour* found = find(i, j)) *found = pool_[places_[i].first + --places_[i].count];
    }

private:
    struct Place {
        std::uint32_t first = 0, count = 0;
        int size = -1;  // of its room; -1 = none
    };
    // 8, 12, 16, 24, 32, ...: blocks cut by two sets of joints have 8 neighbours.
    static std::uint32_t room(const Place& place) {
        return place.size < 0 ? 0 : (2u + static_cast<unsigned>(place.size) % 2) << (place.size / 2 + 2);
    }

    void grow(Place& place) {
        const Place old = place;
        ++place.size;
        auto& free = free_[place.size];
        if (free.empty()) {
            place.first = static_cast<std::uint32_t>(pool_.size());
            const std::size_t needed = pool_.size() + room(place);
            if (needed > pool_.capacity())
                pool_.reserve(needed + needed / 8);  // not twice as much: half of it stayed unused
            pool_.resize(needed);
        } else {
            place.first = free.back();
            free.pop_back();
        }
        for (std::uint32_t k = 0; k < old.count; ++k) pool_[place.first + k] = pool_[old.first + k];
        if (old.size >= 0) free_[old.size].push_back(old.first);
    }

    std::vector<Place> places_;
    std::vector<Neighbour> pool_;
    std::array<std::vector<std::uint32_t>, 64> free_;  // places given back, by size
};

}  // namespace talus
