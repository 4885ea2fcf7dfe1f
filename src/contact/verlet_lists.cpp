// Verlet lists that are repaired box by box: L. Verlet, Phys. Rev. 159 (1967) 98-103, with a margin for each box of its own.
//
// Every box has a coarse box, larger than itself by a margin that goes with its speed. Pairs whose coarse boxes overlapped
// when one of the two was listed are compared at every step. A box that is about to leave its coarse box gets a new one, and
// the pairs that belong to that; nothing is ever listed anew as a whole, so that no step costs much more than the others.
#include "contact/cell_grid.hpp"
#include "contact/moving_search.hpp"
#include "contact/pair_set.hpp"
#include "contact/region_kernels.hpp"
#include "contact/threads.hpp"
#include "contact/viewpoint.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace talus {
namespace {

class VerletLists final : public MovingSearch {
public:
    void update(std::span<const Box> boxes) override {
        boxes_ = boxes;
        ++step_;
        if (std::ssize(boxes) != n_) {
            n_ = static_cast<int>(boxes.size());
            build();
        } else {
            view_.follow(boxes_, false);
            talus::find_escaped(boxes_, view_.centre(), regions_, escaped_);
            looks_ += std::ssize(escaped_);
            if (view_.gone_too_far())
                build();
            else
                for (const int i : escaped_) list_anew(i);
        }
        compare();
        boxes_ = {};
    }

    void pairs(std::vector<Pair>& pairs) const override {
        std::vector<Pair> found;
        found.reserve(2 * static_cast<std::size_t>(n_));
        for (const WatchedPairs& group : groups_)
            for (std::size_t k = 0; k < group.size(); ++k)
                if (group.overlaps(k))
                    found.push_back({std::min(group.box(k), group.other(k)), std::max(group.box(k), group.other(k))});
        sort_pairs(n_, found, pairs);
    }

    int looked_at() const override { return static_cast<int>(escaped_.size()); }
    std::vector<float> speeds() const override { return regions_.speeds(); }
    void expect(const std::vector<float>& speeds) override { regions_.expect(speeds); }

    std::string choice() const override {
        if (step_ == 0) return {};
        std::size_t listed = 0;
        for (const WatchedPairs& group : groups_) listed += group.size();
        char text[120];
        std::snprintf(text, sizeof text, "Verlet lists, %.2g %% of the boxes listed anew in a step, %.2g pairs per box",
                      100.0 * static_cast<double>(looks_) / (static_cast<double>(step_) * std::max(n_, 1)),
                      static_cast<double>(listed) / std::max(n_, 1));
        return text;
    }

private:
    static constexpr int few = 8;    // boxes whose pairs lie together; twice as many: a tenth slower
    static constexpr int rest = 64;  // steps between looks for pairs that came too far apart
    static constexpr double least_margin = 0.1;

    Box seen(int i) const { return view_.seen(boxes_[i]); }

    /// Of the two of a pair the one that keeps it. Half of the pairs of a box are its own wherever it stands in the order. A
    /// hub, such as a base under a whole scene, keeps pairs with hubs only: a list of thousands would be gone through for
    /// each.
    int keeper(int i, int j) const {
        if (hub_[i] != hub_[j]) return hub_[i] ? j : i;
        return ((i ^ j) & 1) != 0 ? std::max(i, j) : std::min(i, j);
    }

    // ---- one box -----------------------------------------------------------------------------------------------------

    void list_anew(int i) {
        if (!present(boxes_[i])) return take_out(i);
        enclose(i);
        groups_[i / few].remove_if([&](std::size_t k) { return groups_[i / few].box(k) == i; });
        grid_.overlapping(grid_.box(i), {}, [&](int j) {
            if (j == i) return;
            if (keeper(i, j) == i || !groups_[j / few].holds(j, i)) keep(i, j);
        });
    }

    // Gives a box its coarse box, and says when it will have to be looked at again.
    void enclose(int i) {
        const Box b = seen(i);
        regions_.move(i, b, step_, view_);
        const CoarseBox outer = coarse(b, wise_margin(i, b, regions_.track[i].speed, view_.typical(), least_margin));
        grid_.holds(i) ? grid_.move(i, outer) : grid_.insert(i, outer);
        regions_.close(i, slack(outer, regions_.reference(i)) - view_.guard(), view_);
    }

    void keep(int i, int j) {
        const int box = keeper(i, j);
        groups_[box / few].add(box, i + j - box, false);
    }

    void take_out(int i) {
        if (grid_.holds(i)) {
            grid_.remove(i);
            for (WatchedPairs& group : groups_)
                group.remove_if([&](std::size_t k) { return group.box(k) == i || group.other(k) == i; });
        }
        regions_.leave_out(i, seen(i), step_, view_);
    }

    // ---- all boxes ---------------------------------------------------------------------------------------------------

    void compare() {
        const int groups = static_cast<int>(groups_.size());
#pragma omp parallel for schedule(static) num_threads(n_ < 4000 ? 1 : threads_allowed())
        for (int g = 0; g < groups; ++g) compare_watched(boxes_, groups_[g]);
        for (int g = step_ % rest; g < groups; g += rest) {
            WatchedPairs& group = groups_[g];
            group.remove_if([&](std::size_t k) { return !grid_.box(group.box(k)).overlaps(grid_.box(group.other(k))); });
        }
    }

    void build() {
        view_.choose(boxes_);
        if (std::ssize(regions_.radius) != n_) regions_.start(n_, step_, 0.0);
        groups_.assign((n_ + few - 1) / few, {});
        grid_.reset(n_, view_.width(), view_.typical());
        for (int i = 0; i < n_; ++i) present(boxes_[i]) ? enclose(i) : take_out(i);
        const std::vector<Pair> near = grid_.all_overlapping();
        hub_ = hubs(near, n_);
        for (const Pair& pair : near) keep(pair.a, pair.b);
    }

    std::span<const Box> boxes_;  // during update() only
    int n_ = 0, step_ = 0;
    Viewpoint view_;
    Regions regions_;  // how far boxes may go before they leave their coarse boxes
    CellGrid grid_;
    std::vector<WatchedPairs> groups_;
    std::vector<char> hub_;
    std::vector<int> escaped_;
    std::int64_t looks_ = 0;
};

}  // namespace

std::unique_ptr<MovingSearch> make_verlet_lists() { return std::make_unique<VerletLists>(); }

}  // namespace talus
