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
            if (std::ssize(speed_) != n_) speed_.assign(n_, 0.0F);
            since_.assign(n_, step_);
            build();
        } else {
            view_.follow(boxes_, false);
            talus::find_escaped(boxes_, view_.centre(), coarse_, escaped_);
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
            for (std::size_t k = 0; k < group.box.size(); ++k)
                if (group.overlaps(k))
                    found.push_back({std::min(group.first(k), group.second(k)), std::max(group.first(k), group.second(k))});
        sort_pairs(n_, found, pairs);
    }

    int looked_at() const override { return static_cast<int>(escaped_.size()); }
    std::vector<float> speeds() const override { return speed_; }
    void expect(std::vector<float> speeds) override { speed_ = std::move(speeds); }

    std::string choice() const override {
        if (step_ == 0) return {};
        std::size_t listed = 0;
        for (const WatchedPairs& group : groups_) listed += group.box.size();
        char text[120];
        std::snprintf(text, sizeof text, "Verlet lists, %.2g %% of the boxes listed anew in a step, %.2g pairs per box",
                      100.0 * static_cast<double>(looks_) / (static_cast<double>(step_) * std::max(n_, 1)),
                      static_cast<double>(listed) / std::max(n_, 1));
        return text;
    }

private:
    static constexpr int few = 8;     // boxes whose pairs lie together; twice as many: a tenth slower
    static constexpr int rest = 64;   // steps between looks for pairs that came too far apart
    static constexpr int many = 512;  // neighbours that make a hub
    static constexpr double least_margin = 0.1;

    Box seen(int i) const { return view_.seen(boxes_[i]); }

    Box reference(int i) const {
        const float* at = &coarse_.at[4 * static_cast<std::size_t>(i)];
        return {at[0], at[1], at[2], at[3]};
    }

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
        const Box b = seen(i);
        if (const int steps = step_ - since_[i]; steps > 0) {
            const Box from = reference(i);
            const double way = std::max(std::max(std::abs(b.xmin - from.xmin), std::abs(b.xmax - from.xmax)),
                                        std::max(std::abs(b.ymin - from.ymin), std::abs(b.ymax - from.ymax)));
            speed_[i] = view_.believable(way) ? static_cast<float>(way / steps) : 0.0F;
        }
        enclose(i, b);
        drop(i);
        grid_.overlapping(grid_.box(i), {}, [&](int j) {
            if (j == i) return;
            if (keeper(i, j) == i || !keeps(j, i)) keep(i, j);
        });
    }

    // Gives a box its coarse box, and says when it will have to be looked at again.
    void enclose(int i, const Box& b) {
        const CoarseBox outer = coarse(b, wise_margin(i, b, speed_[i], view_.typical(), least_margin));
        grid_.holds(i) ? grid_.move(i, outer) : grid_.insert(i, outer);
        since_[i] = step_;
        const Box at = put_reference(i, b);
        coarse_.radius[i] = view_.ordinary(at) ? rounded_down(slack(outer, at) - view_.guard()) : -1.0F;
    }

    Box put_reference(int i, const Box& b) {
        float* at = &coarse_.at[4 * static_cast<std::size_t>(i)];
        at[0] = static_cast<float>(b.xmin), at[1] = static_cast<float>(b.ymin);
        at[2] = static_cast<float>(b.xmax), at[3] = static_cast<float>(b.ymax);
        return reference(i);
    }

    void keep(int i, int j) {
        const int box = keeper(i, j);
        WatchedPairs& group = groups_[box / few];
        group.box.push_back(static_cast<std::uint32_t>(box));
        group.other.push_back(static_cast<std::uint32_t>(i + j - box));
    }

    // Without a way out, which makes it a few vector instructions.
    bool keeps(int i, int j) const {
        const WatchedPairs& group = groups_[i / few];
        const auto here = static_cast<std::uint32_t>(i), there = static_cast<std::uint32_t>(j);
        std::uint32_t found = 0;
        for (std::size_t k = 0; k < group.box.size(); ++k)
            found |= static_cast<std::uint32_t>(group.box[k] == here) &
                     static_cast<std::uint32_t>((group.other[k] & ~WatchedPairs::flag) == there);
        return found != 0;
    }

    template <class Drop>
    static void drop_if(WatchedPairs& group, Drop&& drop) {
        std::size_t kept = 0;
        for (std::size_t k = 0; k < group.box.size(); ++k) {
            group.box[kept] = group.box[k];
            group.other[kept] = group.other[k];
            kept += !drop(k);
        }
        group.box.resize(kept);
        group.other.resize(kept);
    }

    // The pairs that a box keeps itself. Those that others keep with it stay until they are listed anew, and do no harm.
    void drop(int i) {
        WatchedPairs& group = groups_[i / few];
        drop_if(group, [&](std::size_t k) { return group.first(k) == i; });
    }

    void take_out(int i) {
        if (grid_.holds(i)) {
            grid_.remove(i);
            for (WatchedPairs& group : groups_)
                drop_if(group, [&](std::size_t k) { return group.first(k) == i || group.second(k) == i; });
        }
        speed_[i] = 0.0F;
        since_[i] = step_;
        const Box at = put_reference(i, seen(i));
        const double missing = std::max(at.xmin - at.xmax, at.ymin - at.ymax);  // how far from being present
        coarse_.radius[i] = missing > 0.0 && view_.ordinary(at) ? rounded_down(0.25 * missing) : -1.0F;
    }

    // ---- all boxes ---------------------------------------------------------------------------------------------------

    void compare() {
        const int groups = static_cast<int>(groups_.size());
#pragma omp parallel for schedule(static) num_threads(n_ < 4000 ? 1 : threads_allowed())
        for (int g = 0; g < groups; ++g) compare_watched(boxes_, groups_[g]);
        for (int g = step_ % rest; g < groups; g += rest) {
            WatchedPairs& group = groups_[g];
            drop_if(group, [&](std::size_t k) { return !grid_.box(group.first(k)).overlaps(grid_.box(group.second(k))); });
        }
    }

    void build() {
        view_.choose(boxes_);
        coarse_.at.resize(4 * static_cast<std::size_t>(n_));
        coarse_.radius.assign(n_, -1.0F);
        groups_.assign((n_ + few - 1) / few, {});
        grid_.reset(n_, view_.width(), view_.typical());
        hub_.assign(n_, 0);
        for (int i = 0; i < n_; ++i) present(boxes_[i]) ? enclose(i, seen(i)) : take_out(i);
        const std::vector<Pair> near = grid_.all_overlapping();
        std::vector<int> neighbours(n_, 0);
        for (const Pair& pair : near) ++neighbours[pair.a], ++neighbours[pair.b];
        for (int i = 0; i < n_; ++i) hub_[i] = neighbours[i] > many;
        for (const Pair& pair : near) keep(pair.a, pair.b);
    }

    std::span<const Box> boxes_;  // during update() only
    int n_ = 0, step_ = 0;
    Viewpoint view_;
    Regions coarse_;  // how far boxes may go before they leave their coarse boxes
    std::vector<float> speed_;
    std::vector<int> since_;  // step in which a box was listed
    CellGrid grid_;
    std::vector<WatchedPairs> groups_;
    std::vector<char> hub_;
    std::vector<int> escaped_;
    std::int64_t looks_ = 0;
};

}  // namespace

std::unique_ptr<MovingSearch> make_verlet_lists() { return std::make_unique<VerletLists>(); }

}  // namespace talus
