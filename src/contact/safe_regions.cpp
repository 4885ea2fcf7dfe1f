// Safe regions: a box is looked at again only when it has left the region in which none of its pairs can change.
//
// Every box has a coarse box, larger than itself, and the list of all boxes whose coarse boxes overlap its own: no other can
// become its pair before one of the two has left its coarse box. Every box has a reference and a radius; the overlap o of
// two boxes (the smallest of the four differences that must not be negative) changes by at most the sum of their largest
// changes of a bound, so while |o(reference, reference)| >= radius + radius holds and neither has left its region, their
// pair stays as it is. One test per box and step finds those that left; they are measured against their neighbours and get a
// new region.
//
// Pairs that would force many looks, because the two boxes move fast for the little that is left between them, are watched
// instead: compared at every step, as with a Verlet list, and left out of the radius. In cut rock most of them hang on one
// inequality, where the corner of a block is the lowest of one and the highest of the other: then only that is compared. So
// a scene at rest costs one test per box, a scene that mixes becomes a Verlet list of itself, and a slide in a slope is a
// bit of both. What all boxes do in common, such as falling, is taken out: they are seen from a centre that moves with most
// of them.
#include "contact/cell_grid.hpp"
#include "contact/moving_search.hpp"
#include "contact/neighbour_lists.hpp"
#include "contact/pair_set.hpp"
#include "contact/region_kernels.hpp"
#include "contact/threads.hpp"
#include "contact/viewpoint.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>

namespace talus {
namespace {

// The four differences that are all >= 0 for closed boxes that overlap.
struct Differences {
    std::array<double, 4> of;  // upper bound of b - lower bound of a, and the other way round, along x; the same along y

    Differences(const Box& a, const Box& b) : of{b.xmax - a.xmin, a.xmax - b.xmin, b.ymax - a.ymin, a.ymax - b.ymin} {}
    int smallest() const { return static_cast<int>(std::min_element(of.begin(), of.end()) - of.begin()); }
    double rest(int without) const {
        double least = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 4; ++k)
            if (k != without) least = std::min(least, of[k]);
        return least;
    }
};

class SafeRegions final : public MovingSearch {
public:
    void update(std::span<const Box> boxes) override {
        boxes_ = boxes;
        ++step_;
        if (std::ssize(boxes) != n_) {
            n_ = static_cast<int>(boxes.size());
            rebuild();
        } else {
            view_.follow(boxes_, std::ssize(escaped_) <= n_ / 64);
            find_escaped(boxes_, view_.centre(), regions_, escaped_);
            looks_ += std::ssize(escaped_);
            if (view_.gone_too_far() || most_are_gone())
                rebuild();
            else
                for (const int i : escaped_) look_at(i);
        }
        compare();
        boxes_ = {};
    }

    void pairs(std::vector<Pair>& pairs) const override {
        std::vector<Pair> found;
        found.reserve(2 * static_cast<std::size_t>(n_));
        const auto tell = [&](int i, int j) { found.push_back({std::min(i, j), std::max(i, j)}); };
        for (int i = 0; i < n_; ++i)
            for (const Neighbour n : lists_.of(i)) {
                if (n.watch() == Watch::all_bounds || keeper(i, n.box()) != i) continue;
                if (n.watch() == Watch::one_bound ? upper_.overlaps(i, n.box()) : n.overlaps()) tell(i, n.box());
            }
        for (const WatchedPairs& group : watched_)
            for (std::size_t k = 0; k < group.size(); ++k)
                if (group.overlaps(k)) tell(group.box(k), group.other(k));
        sort_pairs(n_, found, pairs);
    }

    // A look takes 1 us where most boxes that are looked at are listed anew, too.
    Costs costs() const override {
        std::size_t watched = 0;
        for (const WatchedPairs& pairs : watched_) watched += pairs.size();
        return {cost_at_rest +
                    (1000.0 * static_cast<double>(escaped_.size()) + 2.2 * static_cast<double>(watched)) / std::max(n_, 1),
                cost_of_lists};
    }
    std::vector<float> speeds() const override { return regions_.speeds(); }
    void expect(const std::vector<float>& speeds) override { regions_.expect(speeds); }

    std::string choice() const override {
        if (step_ == 0) return {};
        std::size_t watched = 0;
        for (int i = 0; i < n_; ++i) watched += (upper_.beyond[i].x != i) + (upper_.beyond[i].y != i);
        for (const WatchedPairs& pairs : watched_) watched += pairs.size();
        char text[120];
        std::snprintf(text, sizeof text,
                      "safe regions, %.2g %% of the boxes looked at in a step, %.2g pairs per box watched",
                      100.0 * static_cast<double>(looks_) / (static_cast<double>(step_) * std::max(n_, 1)),
                      static_cast<double>(watched) / std::max(n_, 1));
        return text;
    }

private:
    // A look costs about as much as 100 comparisons. Half or twice of each number costs up to a tenth more, in slow or in
    // fast scenes.
    static constexpr double patience = 64.0;       // steps that the room of a pair must last, or it is watched
    static constexpr int rest = 64;                // steps between questions whether a pair may be left alone again
    static constexpr double unknown_speed = 2e-5;  // of a block per step, until the first look
    static constexpr int few = 16;                 // boxes whose watched pairs lie together

    // ---- where boxes are, seen from the centre ----------------------------------------------------------------------

    Box seen(int i) const { return view_.seen(boxes_[i]); }

    Box reference(int i) const { return regions_.reference(i); }
    void move_reference(int i) { regions_.move(i, seen(i), step_, view_); }

    /// Whether a box is so far inside its coarse box that it need not be listed anew.
    static bool stays(const CoarseBox& outer, const Box& b) {
        const double left = slack(outer, b);
        return left >= 0.0 && left >= 0.3 * margin_of(outer, b);
    }

    static double margin_of(const CoarseBox& outer, const Box& b) {
        return 0.5 * std::min(outer.xmax - outer.xmin - (b.xmax - b.xmin), outer.ymax - outer.ymin - (b.ymax - b.ymin));
    }

    CoarseBox coarse_box(int i, const Box& b) const {
        return coarse(b, wise_margin(i, b, regions_.track[i].speed, view_.typical(), 0.06));
    }

    // ---- stages of a step ------------------------------------------------------------------------------------------

    /// Whether so many boxes have left their coarse boxes that all are better listed anew.
    bool most_are_gone() const {
        if (std::ssize(escaped_) <= n_ / 4) return false;
        int gone = 0;
        for (const int i : escaped_) {
            const bool here = present(boxes_[i]);
            gone += here != grid_.holds(i) || (here && !(slack(grid_.box(i), seen(i)) >= 0.0));
        }
        return gone > n_ / 4;
    }

    void look_at(int i, bool reconsider = false) {
        if (!present(boxes_[i])) return take_out(i);
        const Box b = seen(i);
        move_reference(i);
        if (!grid_.holds(i) || !stays(grid_.box(i), b)) list(i, b);
        set_region(i, reconsider);
    }

    // Radius of i as far as all pairs allow, for its reference of now.
    void set_region(int i, bool reconsider) {
        const Box mine = reference(i);
        double radius = slack(grid_.box(i), mine) - view_.guard();
        for_each_neighbour(i, [&](const Neighbour n) {
            if (n.watch() == Watch::all_bounds && !reconsider) return;
            radius = std::min(radius, settle(i, mine, n));
        });
        regions_.close(i, radius, view_);
    }

    // Decides how the pair with a neighbour is treated; what that leaves i for its radius, m.
    double settle(int i, const Box& mine, const Neighbour n) {
        const int j = n.box();
        const bool overlaps = boxes_[i].overlaps(boxes_[j]);
        const Differences now(boxes_[i], boxes_[j]);
        const int least = now.smallest();
        const double needed = patience * closing(i, j);
        if (view_.ordinary(mine) && view_.ordinary(reference(j))) {
            // Twice the distance at which watching begins: a pair between the two would change sides at every look.
            const double calm = n.watch() == Watch::not_at_all ? needed : 2.0 * needed + view_.guard();
            if (std::abs(now.of[least]) > calm) {
                const double radius = share(mine, j, -1, overlaps, std::abs(now.of[least]));
                if (radius >= 0.0) {
                    if (n.watch() != Watch::not_at_all || n.overlaps() != overlaps) set(i, j, overlaps, Watch::not_at_all);
                    return radius;
                }
            }
            const int bound = n.watch() == Watch::one_bound ? upper_.of(i, j) : least;
            // What looks at the others would cost shall not come near to what is gained.
            const double enough = n.watch() == Watch::one_bound ? needed : 4.0 * needed;
            if (now.rest(bound) > enough && (n.watch() == Watch::one_bound || upper_.free(i, j, bound))) {
                const double radius = share(mine, j, bound, true, now.rest(bound));
                if (radius >= 0.0) {
                    if (n.watch() != Watch::one_bound) watch_bound(i, j, bound, overlaps);
                    return radius;
                }
            }
        }
        if (n.watch() != Watch::all_bounds) set(i, j, overlaps, Watch::all_bounds);
        return std::numeric_limits<double>::infinity();
    }

    /// m: how far two boxes move in a step, together.
    double closing(int i, int j) const { return regions_.speed(i, seen(i), step_) + regions_.speed(j, seen(j), step_); }

    // What the pair with j leaves i for its radius, if its differences but `without` are to keep the sign they have;
    // negative if they can change at once. `room`: by how much they have it now.
    double share(const Box& mine, int j, int without, bool positive, double room) {
        Box other = reference(j);
        double certain = this->certain(mine, other, without, positive);
        const double taken = std::max(regions_.radius[j], 0.0F);
        if (certain - taken >= 0.5 * room) return certain - taken;
        // The region of j takes too much: it shrinks to a ball within itself, around where j is now.
        move_reference(j);
        const double kept = regions_.radius[j] - farthest(reference(j), other) - view_.guard();
        other = reference(j);
        certain = this->certain(mine, other, without, positive);
        regions_.radius[j] = rounded_down(certain >= 0.0 ? std::min(kept, 0.5 * certain) : kept);
        return certain >= 0.0 ? certain - std::max(regions_.radius[j], 0.0F) : certain;
    }

    /// m: how much two boxes may change from their references before a sign can; negative if it can at once.
    double certain(const Box& a, const Box& b, int without, bool positive) const {
        const double least = Differences(a, b).rest(without);
        return (least >= 0.0) == positive ? std::abs(least) - view_.guard() : -1.0;
    }

    // ---- pairs that are watched -----------------------------------------------------------------------------------------

    void watch_bound(int i, int j, int k, bool overlaps) {
        set(i, j, overlaps, Watch::one_bound);
        upper_.watch(i, j, k, overlaps);
    }

    void compare() {
        const int words = static_cast<int>(upper_.watching.size()), groups = static_cast<int>(watched_.size());
#pragma omp parallel num_threads(n_ < 4000 ? 1 : threads_allowed())
        {
#pragma omp for schedule(static) nowait
            for (int g = 0; g < groups; ++g) compare_watched(boxes_, watched_[g]);
#pragma omp for schedule(static)
            for (int w = 0; w < words; ++w) compare_upper_bounds(boxes_, w, upper_);
        }
        for (int g = step_ % rest; g < groups; g += rest) reconsider_watched(g);
        for (int w = step_ % rest; w < words; w += rest) reconsider_upper_bounds(w);
    }

    // Asks pairs that are watched whether they may be left alone again.
    void reconsider_watched(int group) {
        const WatchedPairs& pairs = watched_[group];
        calm_.clear();
        for (std::size_t k = 0; k < pairs.size(); ++k) {
            if (calm(pairs.box(k), pairs.other(k))) calm_.push_back(pairs.box(k));
        }
        std::sort(calm_.begin(), calm_.end());
        calm_.erase(std::unique(calm_.begin(), calm_.end()), calm_.end());
        for (const int i : calm_) look_at(i, true);
    }

    void reconsider_upper_bounds(int w) {
        for (std::uint64_t left = upper_.watching[w]; left != 0; left &= left - 1) {
            const int i = 64 * w + std::countr_zero(left);
            const UpperBounds::Beyond beyond = upper_.beyond[i];
            if (beyond.x == i && beyond.y == i) upper_.watching[w] &= ~(std::uint64_t{1} << (i % 64));
            if ((beyond.x != i && calm(i, beyond.x)) || (beyond.y != i && calm(i, beyond.y))) look_at(i);
        }
    }

    bool calm(int i, int j) const {
        const Differences now(boxes_[i], boxes_[j]);
        return std::abs(now.of[now.smallest()]) > 2.0 * patience * closing(i, j) + view_.guard();
    }

    // ---- lists of neighbours -----------------------------------------------------------------------------------------

    // A hub is a box with very many neighbours, such as a base under a whole scene. It lists other hubs only; all others
    // list the hubs they meet, and the rare question who is near a hub goes through all boxes.
    bool stores(int i, int j) const { return !hub_[i] || hub_[j]; }

    /// Of the two of a pair, the one that watches it and tells of it.
    int keeper(int i, int j) const { return hub_[i] != hub_[j] ? (hub_[i] ? j : i) : std::min(i, j); }

    void set(int i, int j, bool overlaps, Watch watch) {
        forget(i, j);
        if (stores(i, j)) *lists_.find(i, j) = Neighbour(j, overlaps, watch);
        if (stores(j, i)) *lists_.find(j, i) = Neighbour(i, overlaps, watch);
        if (watch != Watch::all_bounds) return;
        const int box = keeper(i, j);
        watched_[box / few].add(box, i + j - box, overlaps);
    }

    /// The pair is watched no more.
    void forget(int i, int j) {
        const int box = keeper(i, j);
        const Watch watch = lists_.find(box, i + j - box)->watch();
        if (watch == Watch::one_bound) upper_.forget(i, j);
        if (watch == Watch::all_bounds) watched_[box / few].remove(box, i + j - box);
    }

    template <class Visit>
    void for_each_neighbour(int i, Visit&& visit) {
        seen_.assign(lists_.of(i).begin(), lists_.of(i).end());  // what is set moves in the list
        for (const Neighbour n : seen_) visit(n);
        if (!hub_[i]) return;
        for (int j = 0; j < n_; ++j)
            if (!hub_[j])
                if (const Neighbour* n = lists_.find(j, i)) visit(Neighbour(j, n->overlaps(), n->watch()));
    }

    void join(int i, int j) {
        const bool overlaps = boxes_[i].overlaps(boxes_[j]);
        if (stores(i, j)) lists_.add(i, Neighbour(j, overlaps, Watch::not_at_all));
        if (stores(j, i)) lists_.add(j, Neighbour(i, overlaps, Watch::not_at_all));
    }

    void part(int i, int j) {
        forget(i, j);
        if (stores(i, j)) lists_.remove(i, j);
        if (stores(j, i)) lists_.remove(j, i);
    }

    /// Gives a box its coarse box anew, and the list that belongs to it.
    void list(int i, const Box& b) {
        const CoarseBox outer = coarse_box(i, b);
        old_.clear();
        for_each_neighbour(i, [&](const Neighbour n) { old_.push_back(n.box()); });
        grid_.overlapping(outer, old_, [&](int j) {
            if (j != i) join(i, j);
        });
        for (const int j : old_)
            if (!grid_.box(j).overlaps(outer)) part(i, j);
        grid_.holds(i) ? grid_.move(i, outer) : grid_.insert(i, outer);
    }

    void take_out(int i) {
        if (grid_.holds(i)) {
            old_.clear();
            for_each_neighbour(i, [&](const Neighbour n) { old_.push_back(n.box()); });
            for (const int j : old_) part(i, j);
            grid_.remove(i);
        }
        regions_.leave_out(i, seen(i), step_, view_);
    }

    // ---- from nothing ------------------------------------------------------------------------------------------------

    void rebuild() {
        view_.choose(boxes_);
        if (std::ssize(regions_.radius) != n_) regions_.start(n_, step_, unknown_speed * view_.typical());
        grid_.reset(n_, view_.width(), view_.typical());
        lists_.reset(n_);
        hub_.assign(n_, 0);
        upper_.reset(n_);
        watched_.assign((n_ + few - 1) / few, {});
        for (int i = 0; i < n_; ++i) {
            if (!present(boxes_[i])) {
                take_out(i);
                continue;
            }
            const Box b = seen(i);
            move_reference(i);
            grid_.insert(i, coarse_box(i, b));
        }
        const std::vector<Pair> near = grid_.all_overlapping();
        hub_ = hubs(near, n_);
        for (const Pair& pair : near) join(pair.a, pair.b);
        for (int i = 0; i < n_; ++i)
            if (grid_.holds(i)) first_region(i);
    }

    // As set_region, but every pair gives half of its room to each of the two.
    void first_region(int i) {
        const Box mine = reference(i);
        double radius = slack(grid_.box(i), mine) - view_.guard();
        for_each_neighbour(i, [&](const Neighbour n) {
            const int j = n.box();
            const bool usual = view_.ordinary(mine) && view_.ordinary(reference(j));
            const Differences now(mine, reference(j));
            const double needed = patience * closing(i, j) + view_.guard();
            int bound = n.watch() == Watch::one_bound ? upper_.of(i, j) : now.smallest();
            if (n.watch() == Watch::all_bounds) return;
            if (n.watch() == Watch::not_at_all) {
                const double room = certain(mine, reference(j), -1, n.overlaps());
                if (usual && room > needed) {
                    radius = std::min(radius, 0.5 * room);
                    return;
                }
                if (!usual || !(now.rest(bound) > 4.0 * needed) || !upper_.free(i, j, bound))
                    return set(i, j, n.overlaps(), Watch::all_bounds);
                watch_bound(i, j, bound, n.overlaps());
            }
            radius = std::min(radius, 0.5 * certain(mine, reference(j), bound, true));
        });
        regions_.close(i, radius, view_);
    }

    std::span<const Box> boxes_;  // during update() only
    int n_ = 0, step_ = 0;
    Viewpoint view_;

    Regions regions_;
    CellGrid grid_;  // coarse boxes
    NeighbourLists lists_;
    UpperBounds upper_;
    std::vector<WatchedPairs> watched_;  // by groups of boxes
    std::vector<char> hub_;

    std::vector<int> escaped_;
    std::vector<int> old_, calm_;
    std::vector<Neighbour> seen_;
    std::int64_t looks_ = 0;
};

}  // namespace

std::unique_ptr<MovingSearch> make_safe_regions() { return std::make_unique<SafeRegions>(); }

}  // namespace talus
