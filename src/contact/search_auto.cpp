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
#include "contact/neighbour_lists.hpp"
#include "contact/region_kernels.hpp"
#include "contact/search_methods.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace talus {
namespace {

int thread_count() {
#ifdef _OPENMP
    return omp_get_max_threads();
#else
    return 1;
#endif
}

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

double farthest(const Box& a, const Box& b) {
    return std::max(std::max(std::abs(a.xmin - b.xmin), std::abs(a.xmax - b.xmax)),
                    std::max(std::abs(a.ymin - b.ymin), std::abs(a.ymax - b.ymax)));
}

float rounded_down(double x) {
    const float f = static_cast<float>(x);
    return f > x ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}

float rounded_up(double x) { return -rounded_down(-x); }

class AutoSearch final : public PairSearch {
public:
    void update(std::span<const Box> boxes) override {
        boxes_ = boxes;
        ++step_;
        if (std::ssize(boxes) != n_) {
            n_ = static_cast<int>(boxes.size());
            track_.clear();
            rebuild();
        } else {
            follow();
            find_escaped();
            if (rounding() > guard_ || most_are_gone())
                rebuild();
            else
                for (const int i : escaped_) look_at(i);
        }
        compare();
        boxes_ = {};
    }

    void pairs(std::vector<Pair>& pairs) const override {
        pairs.clear();
        bool sorted = true;
        for (int w = 0; w < static_cast<int>(watched_.size()); ++w) {
            const std::size_t first = pairs.size();
            const auto tell = [&](int i, int j) {
                pairs.push_back({std::min(i, j), std::max(i, j)});
                sorted = sorted && i < j;
            };
            for (int i = few * w; i < std::min(few * w + few, n_); ++i)
                for (const Neighbour n : lists_.of(i)) {
                    if (n.watch() == Watch::all_bounds || keeper(i, n.box()) != i) continue;
                    if (n.watch() == Watch::one_bound ? reaches(i, n.box()) : n.overlaps()) tell(i, n.box());
                }
            for (std::size_t k = 0; k < watched_[w].box.size(); ++k)
                if (watched_[w].other[k] & WatchedPairs::flag)
                    tell(static_cast<int>(watched_[w].box[k]), static_cast<int>(watched_[w].other[k] & ~WatchedPairs::flag));
            std::sort(pairs.begin() + static_cast<std::ptrdiff_t>(first), pairs.end());
        }
        if (!sorted) std::sort(pairs.begin(), pairs.end());
    }

    std::string choice() const override {
        if (step_ == 0) return {};
        std::size_t watched = 0;
        for (int i = 0; i < n_; ++i) watched += (upper_.beyond[i].x != i) + (upper_.beyond[i].y != i);
        for (const WatchedPairs& pairs : watched_) watched += pairs.box.size();
        char text[120];
        std::snprintf(text, sizeof text,
                      "safe regions, %.2g %% of the boxes looked at in a step, %.2g pairs per box watched",
                      100.0 * static_cast<double>(looks_) / (static_cast<double>(step_) * std::max(n_, 1)),
                      static_cast<double>(watched) / std::max(n_, 1));
        return text;
    }

private:
    struct Track {
        float speed = 0.0F;  // m per step: how far a bound went, over the steps it took
        int since = 0;       // step of the reference
    };
    // A look costs about as much as 100 comparisons. Half or twice of each number costs up to a tenth more, in slow or in
    // fast scenes.
    static constexpr double patience = 64.0;       // steps that the room of a pair must last, or it is watched
    static constexpr int rest = 64;                // steps between questions whether a pair may be left alone again
    static constexpr double margin_growth = 20.0;  // margin = sqrt(this x speed x size)
    static constexpr double unknown_speed = 2e-5;  // of a block per step, until the first look
    static constexpr int sample_size = 31;         // boxes that tell of common motion
    static constexpr int few = 16;                 // boxes whose watched pairs lie together
    static constexpr int many = 512;  // neighbours that make a hub: to find one of so many takes half a microsecond

    // ---- where boxes are, seen from the centre ----------------------------------------------------------------------

    Box seen(int i) const {
        const Box& b = boxes_[i];
        return {b.xmin - centre_.x(), b.ymin - centre_.y(), b.xmax - centre_.x(), b.ymax - centre_.y()};
    }

    Box reference(int i) const {
        const float* at = &regions_.at[4 * static_cast<std::size_t>(i)];
        return {at[0], at[1], at[2], at[3]};
    }

    void move_reference(int i, const Box& b) {
        const double speed = this->speed(i, b);
        track_[i] = {speed < far_ ? static_cast<float>(speed) : 0.0F, step_};
        float* at = &regions_.at[4 * static_cast<std::size_t>(i)];
        at[0] = static_cast<float>(b.xmin), at[1] = static_cast<float>(b.ymin);
        at[2] = static_cast<float>(b.xmax), at[3] = static_cast<float>(b.ymax);
    }

    /// m per step; b: where box i is now.
    double speed(int i, const Box& b) const {
        const Track& track = track_[i];
        const int steps = step_ - track.since;
        return steps == 0 ? track.speed : farthest(b, reference(i)) / steps;
    }

    /// m: how far a box may change before it leaves its coarse box.
    static double slack(const CoarseBox& outer, const Box& b) {
        return std::min(std::min(b.xmin - outer.xmin, outer.xmax - b.xmax),
                        std::min(b.ymin - outer.ymin, outer.ymax - b.ymax));
    }

    /// Whether a box is so far inside its coarse box that it need not be listed anew.
    static bool stays(const CoarseBox& outer, const Box& b) {
        const double left = slack(outer, b);
        return left >= 0.0 && left >= 0.3 * margin_of(outer, b);
    }

    static double margin_of(const CoarseBox& outer, const Box& b) {
        return 0.5 * std::min(outer.xmax - outer.xmin - (b.xmax - b.xmin), outer.ymax - outer.ymin - (b.ymax - b.ymin));
    }

    /// Coarse boxes so large that fast boxes are listed anew every some twenty steps, and slow ones hardly ever. Margins
    /// differ a little from box to box, so that boxes that move together do not all come at the same step.
    double margin(int i, const Box& b) const {
        const double own = std::max(b.xmax - b.xmin, b.ymax - b.ymin) + 0.1 * typical_;
        const double size = own < typical_ ? own : typical_;
        const double wanted = std::sqrt(margin_growth * track_[i].speed * size);
        const double varied = 0.75 + 0.5 * ((static_cast<std::uint32_t>(i) * 2654435769u) >> 8) * 0x1p-24;
        return varied * std::clamp(wanted, 0.06 * size, 0.5 * size);
    }

    static CoarseBox coarse(const Box& b, double margin) {
        return {rounded_down(b.xmin - margin), rounded_down(b.ymin - margin), rounded_up(b.xmax + margin),
                rounded_up(b.ymax + margin)};
    }

    // ---- stages of a step ------------------------------------------------------------------------------------------

    // Lets the centre go along with what most of the boxes did since the last step. A sample tells; where its members go
    // many ways, the centre stays. Where hardly a box escapes there is nothing to gain, and nobody is asked.
    void follow() {
        if (std::ssize(escaped_) > n_ / 64) {
            if (following_ == 0) sample_.fill(Vec2::Constant(std::numeric_limits<double>::quiet_NaN()));
            following_ = rest;
        }
        if (following_ == 0) return;
        --following_;
        const int every = std::max(1, n_ / sample_size);
        std::array<std::array<double, sample_size>, 2> moved;
        int count = 0;
        for (int k = 0; k < sample_size && k * every < n_; ++k) {
            const Box& b = boxes_[k * every];
            const Vec2 now(0.5 * b.xmin + 0.5 * b.xmax, 0.5 * b.ymin + 0.5 * b.ymax);
            const Vec2 step = now - sample_[k];
            sample_[k] = now;
            if (!std::isfinite(step.x() + step.y())) continue;
            moved[0][count] = step.x();
            moved[1][count++] = step.y();
        }
        if (count == 0) return;
        Vec2 common;
        for (int axis = 0; axis < 2; ++axis) {
            const std::span all(moved[axis].data(), count);
            const double middle = median(all);
            for (double& each : all) each = std::abs(each - middle);
            common[axis] = std::abs(middle) > 4.0 * median(all) ? middle : 0.0;
        }
        if (common.isZero() || common.cwiseAbs().maxCoeff() > typical_) return;
        centre_ += common;
        following_ = rest;
    }

    static double median(std::span<double> values) {
        const auto middle = values.begin() + std::ssize(values) / 2;
        std::nth_element(values.begin(), middle, values.end());
        return *middle;
    }

    void find_escaped() {
        escaped_.clear();
        const int threads = n_ < 20000 ? 1 : thread_count();
        if (threads == 1) {
            talus::find_escaped(boxes_, centre_, regions_, 0, n_, escaped_);
        } else {
            escaped_of_.resize(threads);
#pragma omp parallel for schedule(static) num_threads(threads)
            for (int t = 0; t < threads; ++t) {
                escaped_of_[t].clear();
                const auto at = [&](int k) { return static_cast<int>(static_cast<std::int64_t>(n_) * k / threads); };
                talus::find_escaped(boxes_, centre_, regions_, at(t), at(t + 1), escaped_of_[t]);
            }
            for (const auto& found : escaped_of_) escaped_.insert(escaped_.end(), found.begin(), found.end());
        }
        looks_ += std::ssize(escaped_);
    }

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
        move_reference(i, b);
        if (!grid_.holds(i) || !stays(grid_.box(i), b)) list(i, b);
        set_region(i, reconsider);
    }

    // Radius of i as far as all pairs allow, for its reference of now.
    void set_region(int i, bool reconsider) {
        const Box mine = reference(i);
        double radius = slack(grid_.box(i), mine) - guard_;
        for_each_neighbour(i, [&](const Neighbour n) {
            if (n.watch() == Watch::all_bounds && !reconsider) return;
            radius = std::min(radius, settle(i, mine, n));
        });
        regions_.radius[i] = ordinary(mine) ? rounded_down(radius) : -1.0F;
    }

    // Decides how the pair with a neighbour is treated; what that leaves i for its radius, m.
    double settle(int i, const Box& mine, const Neighbour n) {
        const int j = n.box();
        const bool overlaps = boxes_[i].overlaps(boxes_[j]);
        const Differences now(boxes_[i], boxes_[j]);
        const int least = now.smallest();
        const double needed = patience * closing(i, j);
        if (ordinary(mine) && ordinary(reference(j))) {
            // Twice the distance at which watching begins: a pair between the two would change sides at every look.
            const double calm = n.watch() == Watch::not_at_all ? needed : 2.0 * needed + guard_;
            if (std::abs(now.of[least]) > calm) {
                const double radius = share(mine, j, -1, overlaps, std::abs(now.of[least]));
                if (radius >= 0.0) {
                    if (n.watch() != Watch::not_at_all || n.overlaps() != overlaps) set(i, j, overlaps, Watch::not_at_all);
                    return radius;
                }
            }
            const int bound = n.watch() == Watch::one_bound ? watched_bound(i, j) : least;
            // What looks at the others would cost shall not come near to what is gained.
            const double enough = n.watch() == Watch::one_bound ? needed : 4.0 * needed;
            if (now.rest(bound) > enough && (n.watch() == Watch::one_bound || free(i, j, bound))) {
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
    double closing(int i, int j) const { return speed(i, seen(i)) + speed(j, seen(j)); }

    // What the pair with j leaves i for its radius, if its differences but `without` are to keep the sign they have;
    // negative if they can change at once. `room`: by how much they have it now.
    double share(const Box& mine, int j, int without, bool positive, double room) {
        Box other = reference(j);
        double certain = this->certain(mine, other, without, positive);
        const double taken = std::max(regions_.radius[j], 0.0F);
        if (certain - taken >= 0.5 * room) return certain - taken;
        // The region of j takes too much: it shrinks to a ball within itself, around where j is now.
        move_reference(j, seen(j));
        const double kept = regions_.radius[j] - farthest(reference(j), other) - guard_;
        other = reference(j);
        certain = this->certain(mine, other, without, positive);
        regions_.radius[j] = rounded_down(certain >= 0.0 ? std::min(kept, 0.5 * certain) : kept);
        return certain >= 0.0 ? certain - std::max(regions_.radius[j], 0.0F) : certain;
    }

    /// m: how much two boxes may change from their references before a sign can; negative if it can at once.
    double certain(const Box& a, const Box& b, int without, bool positive) const {
        const double least = Differences(a, b).rest(without);
        return (least >= 0.0) == positive ? std::abs(least) - guard_ : -1.0;
    }

    // ---- pairs that are watched -----------------------------------------------------------------------------------------

    // Bound k of i against j, as in Differences(i, j): even numbers are upper bounds of j, odd ones of i.
    bool free(int i, int j, int k) const {
        const int who = k % 2 == 0 ? j : i;
        return (k < 2 ? upper_.beyond[who].x : upper_.beyond[who].y) == who;
    }

    int watched_bound(int i, int j) const {
        const auto &mine = upper_.beyond[i], &other = upper_.beyond[j];
        return other.x == i ? 0 : mine.x == j ? 1 : other.y == i ? 2 : 3;
    }

    bool reaches(int i, int j) const {
        const int k = watched_bound(i, j);
        const UpperBounds::Reaches here = upper_.reaches[k % 2 == 0 ? j : i];
        return k < 2 ? here.x : here.y;
    }

    void watch_bound(int i, int j, int k, bool overlaps) {
        set(i, j, overlaps, Watch::one_bound);
        const int who = k % 2 == 0 ? j : i, other = k % 2 == 0 ? i : j;
        (k < 2 ? upper_.beyond[who].x : upper_.beyond[who].y) = other;
        (k < 2 ? upper_.reaches[who].x : upper_.reaches[who].y) = overlaps;
        upper_.watching[who / 64] |= std::uint64_t{1} << (who % 64);
    }

    void forget_bound(int i, int j) {
        auto &mine = upper_.beyond[i], &other = upper_.beyond[j];
        if (mine.x == j) mine.x = i;
        if (mine.y == j) mine.y = i;
        if (other.x == i) other.x = j;
        if (other.y == i) other.y = j;
    }

    void compare() {
        const int words = static_cast<int>(upper_.watching.size()), groups = static_cast<int>(watched_.size());
        const int threads = n_ < 4000 ? 1 : thread_count();
#pragma omp parallel num_threads(threads)
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
        for (std::size_t k = 0; k < pairs.box.size(); ++k) {
            const int i = static_cast<int>(pairs.box[k]);
            if (calm(i, static_cast<int>(pairs.other[k] & ~WatchedPairs::flag))) calm_.push_back(i);
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
        return std::abs(now.of[now.smallest()]) > 2.0 * patience * closing(i, j) + guard_;
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
        WatchedPairs& pairs = watched_[box / few];
        pairs.box.push_back(static_cast<std::uint32_t>(box));
        pairs.other.push_back(static_cast<std::uint32_t>(i + j - box) | (overlaps ? WatchedPairs::flag : 0));
    }

    /// The pair is watched no more.
    void forget(int i, int j) {
        const int box = keeper(i, j);
        const Watch watch = lists_.find(box, i + j - box)->watch();
        if (watch == Watch::one_bound) forget_bound(i, j);
        if (watch != Watch::all_bounds) return;
        const auto here = static_cast<std::uint32_t>(box), there = static_cast<std::uint32_t>(i + j - box);
        WatchedPairs& pairs = watched_[box / few];
        std::size_t k = 0;
        while (pairs.box[k] != here || (pairs.other[k] & ~WatchedPairs::flag) != there) ++k;
        pairs.box[k] = pairs.box.back();
        pairs.other[k] = pairs.other.back();
        pairs.box.pop_back();
        pairs.other.pop_back();
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
        const CoarseBox outer = coarse(b, margin(i, b));
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
        move_reference(i, seen(i));
        track_[i].speed = 0.0F;
        const Box at = reference(i);
        const double missing = std::max(at.xmin - at.xmax, at.ymin - at.ymax);  // how far from being present
        regions_.radius[i] = missing > 0.0 && ordinary(at) ? rounded_down(0.25 * missing) : -1.0F;
    }

    // ---- from nothing ------------------------------------------------------------------------------------------------

    void rebuild() {
        choose_measures();
        regions_.at.resize(4 * static_cast<std::size_t>(n_));
        regions_.radius.assign(n_, -1.0F);
        if (track_.empty()) track_.assign(n_, {static_cast<float>(unknown_speed * typical_), step_});
        grid_.reset(n_, 0.25 * far_, typical_);
        lists_.reset(n_);
        hub_.assign(n_, 0);
        upper_.reaches.assign(n_, {true, true});
        upper_.beyond.resize(n_);
        for (int i = 0; i < n_; ++i) upper_.beyond[i] = {i, i};
        upper_.watching.assign((n_ + 63) / 64, 0);
        watched_.assign((n_ + few - 1) / few, {});
        for (int i = 0; i < n_; ++i) {
            if (!present(boxes_[i])) {
                take_out(i);
                continue;
            }
            const Box b = seen(i);
            move_reference(i, b);
            grid_.insert(i, coarse(b, margin(i, b)));
        }
        for (int i = 0; i < n_; ++i) {
            if (!grid_.holds(i)) continue;
            grid_.overlapping(grid_.box(i), {}, [&](int j) {
                if (j != i) lists_.add(i, Neighbour(j, boxes_[i].overlaps(boxes_[j]), Watch::not_at_all));
            });
            hub_[i] = lists_.of(i).size() > many;
        }
        for (int i = 0; i < n_; ++i) {
            if (!hub_[i]) continue;
            old_.clear();
            for (const Neighbour n : lists_.of(i))
                if (!hub_[n.box()]) old_.push_back(n.box());
            for (const int j : old_) lists_.remove(i, j);
        }
        for (int i = 0; i < n_; ++i)
            if (grid_.holds(i)) first_region(i);
    }

    // As set_region, but every pair gives half of its room to each of the two.
    void first_region(int i) {
        const Box mine = reference(i);
        double radius = slack(grid_.box(i), mine) - guard_;
        for_each_neighbour(i, [&](const Neighbour n) {
            const int j = n.box();
            const bool usual = ordinary(mine) && ordinary(reference(j));
            const Differences now(mine, reference(j));
            const double needed = patience * closing(i, j) + guard_;
            int bound = n.watch() == Watch::one_bound ? watched_bound(i, j) : now.smallest();
            if (n.watch() == Watch::all_bounds) return;
            if (n.watch() == Watch::not_at_all) {
                const double room = certain(mine, reference(j), -1, n.overlaps());
                if (usual && room > needed) {
                    radius = std::min(radius, 0.5 * room);
                    return;
                }
                if (!usual || !(now.rest(bound) > 4.0 * needed) || !free(i, j, bound))
                    return set(i, j, n.overlaps(), Watch::all_bounds);
                watch_bound(i, j, bound, n.overlaps());
            }
            radius = std::min(radius, 0.5 * certain(mine, reference(j), bound, true));
        });
        if (ordinary(mine)) regions_.radius[i] = rounded_down(radius);
    }

    // Centre and sizes of the scene, from the middle of all boxes: what lies far out or is of no size spoils nothing.
    void choose_measures() {
        std::vector<double> x, y, size, far;
        for (const Box& b : boxes_) {
            if (!present(b)) continue;
            x.push_back(0.5 * b.xmin + 0.5 * b.xmax);
            y.push_back(0.5 * b.ymin + 0.5 * b.ymax);
            size.push_back(std::max(b.xmax - b.xmin, b.ymax - b.ymin));
        }
        centre_ = {at_rank(x, 0.5), at_rank(y, 0.5)};
        typical_ = at_rank(size, 0.5);
        if (!(typical_ > 0.0 && typical_ < 1e30)) typical_ = 1.0;
        if (!(std::abs(centre_.x()) < 1e30 && std::abs(centre_.y()) < 1e30)) centre_ = {0.0, 0.0};
        for (int i = 0; i < n_; ++i) {
            if (!present(boxes_[i])) continue;
            const Box b = seen(i);
            far.push_back(
                std::max(std::max(std::abs(b.xmin), std::abs(b.xmax)), std::max(std::abs(b.ymin), std::abs(b.ymax))));
        }
        far_ = std::min(8.0 * (at_rank(far, 0.98) + typical_), 1e30);
        guard_ = 2.0 * rounding();
    }

    /// m: more than all rounding of what is compared with a radius.
    double rounding() const { return 0x1p-48 * (far_ + std::abs(centre_.x()) + std::abs(centre_.y())); }

    static double at_rank(std::vector<double>& values, double share) {
        if (values.empty()) return 0.0;
        const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
        std::nth_element(values.begin(), at, values.end());
        return *at;
    }

    /// Not so far out that the guard against rounding would be too small.
    bool ordinary(const Box& b) const { return b.xmin >= -far_ && b.ymin >= -far_ && b.xmax <= far_ && b.ymax <= far_; }

    std::span<const Box> boxes_;  // during update() only
    int n_ = 0, step_ = 0;
    Vec2 centre_ = Vec2::Zero();            // m; what is seen from it is rounded, but in the same way for all
    int following_ = 0;                     // steps for which the centre may move
    std::array<Vec2, sample_size> sample_;  // m, middles of some boxes in the last step
    double typical_ = 1.0;                  // m, size of a box in the middle
    double far_ = 1.0;                      // m, beyond it boxes are looked at in every step
    double guard_ = 0.0;                    // m, see rounding(); twice of it, for the centre moves

    Regions regions_;
    std::vector<Track> track_;
    CellGrid grid_;  // coarse boxes
    NeighbourLists lists_;
    UpperBounds upper_;
    std::vector<WatchedPairs> watched_;  // by groups of boxes
    std::vector<char> hub_;

    std::vector<int> escaped_;
    std::vector<std::vector<int>> escaped_of_;  // by thread
    std::vector<int> old_, calm_;
    std::vector<Neighbour> seen_;
    std::int64_t looks_ = 0;
};

}  // namespace

std::unique_ptr<PairSearch> make_auto_search() { return std::make_unique<AutoSearch>(); }

}  // namespace talus
