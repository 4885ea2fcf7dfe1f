// Searches that know how fast boxes move, and what `auto` needs to choose between them.
#pragma once

#include "contact/search.hpp"

namespace talus {

class MovingSearch : public PairSearch {
public:
    /// How many boxes the last update had to look at one by one.
    virtual int looked_at() const = 0;

    /// m per step, of every box.
    virtual std::vector<float> speeds() const = 0;

    /// What speeds() of another search told, before the first update.
    virtual void expect(const std::vector<float>& speeds) = 0;
};

/// For boxes that hardly move, or hardly against each other: safe_regions.cpp.
std::unique_ptr<MovingSearch> make_safe_regions();

/// For boxes that mix: verlet_lists.cpp.
std::unique_ptr<MovingSearch> make_verlet_lists();

}  // namespace talus
