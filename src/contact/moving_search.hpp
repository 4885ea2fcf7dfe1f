// The two searches that `auto` chooses between, and what it needs for that.
#pragma once

#include "contact/search.hpp"

namespace talus {

class MovingSearch : public PairSearch {
public:
    /// ns per box, one thread: what the last update took, by the count of what it did, and what the other search would take,
    /// as far as this one can tell. Counted, not timed: a run takes the same way on any machine and any day.
    struct Costs {
        double mine, other;
    };
    virtual Costs costs() const = 0;

    /// m per step, of every box.
    virtual std::vector<float> speeds() const = 0;

    /// What speeds() of another search told, before the first update.
    virtual void expect(const std::vector<float>& speeds) = 0;
};

/// ns per box: what safe regions take where boxes move by this part of their size per step, on average. Measured, in slopes
/// and in rubble; where joints lie along the axes, they take several times as much.
constexpr double cost_at_rest = 2.0;
inline double cost_of_regions(double pace) { return cost_at_rest + 1.5e4 * pace; }

/// ns per box: what lists take at a moderate pace.
constexpr double cost_of_lists = 7.5;

/// For boxes that hardly move, or hardly against each other: safe_regions.cpp.
std::unique_ptr<MovingSearch> make_safe_regions();

/// For boxes that mix, or of which none can be left alone: verlet_lists.cpp.
std::unique_ptr<MovingSearch> make_verlet_lists();

}  // namespace talus
