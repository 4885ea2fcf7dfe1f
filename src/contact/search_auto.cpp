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
// instead: compared at every step, as with a Verlet list, and left out of the radius. So a scene at rest costs one test per
// box, a scene that mixes becomes a Verlet list of itself, and a slide in a slope is a bit of both.
#include "contact/cell_grid.hpp"
#include "contact/neighbour_lists.hpp"
#include "contact/region_kernels.hpp"
#include "contact/search_methods.hpp"

#include <algorithm>
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

// The smallest of the four differences that are all >= 0 for closed boxes that overlap.
double overlap(const Box& a, const Box& b) {
    return std::min(std::min(b.xmax - a.xmin, a.xmax - b.xmin), std::min(b.ymax - a.ymin, a.ymax - b.ymin));
}

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
            find_escaped();
            if (most_are_gone())
                rebuild();
            else
                for (const int i : escaped_) look_at(i);
            compare_watched();
        }
        boxes_ = {};
    }

    void pairs(std::vector<Pair>& pairs) const override {
        pairs.clear();
        bool sorted = true;
        for (int i = 0; i < n_; ++i) {
            const std::size_t first = pairs.size();
            for (const Neighbour n : lists_.of(i)) {
                if (!n.overlaps()) continue;
                if (n.box() > i) {
                    if (keeper(i, n.box()) == i) pairs.push_back({i, n.box()});
                } else if (keeper(n.box(), i) == i) {
                    pairs.push_back({n.box(), i});
                    sorted = false;
                }
            }
            std::sort(pairs.begin() + static_cast<std::ptrdiff_t>(first), pairs.end());
        }
        if (!sorted) std::sort(pairs.begin(), pairs.end());
    }

    std::string choice() const override {
        if (step_ == 0) return {};
        std::size_t watched = 0;
        for (int i = 0; i < n_; ++i) watched += lists_.watched_by(i).size();
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
    static constexpr double patience = 40.0;       // steps that the room of a pair must last, or it is watched
    static constexpr int rest = 64;                // steps between questions whether a pair may be left alone again
    static constexpr double margin_growth = 12.0;  // margin = sqrt(this x speed x size)
    static constexpr double unknown_speed = 2e-5;  // of a block per step, until the first look
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

    // Radius of i as far as all pairs allow that are not watched, for its reference of now.
    void set_region(int i, bool reconsider) {
        const Box mine = reference(i);
        double radius = slack(grid_.box(i), mine) - guard_;
        for_each_neighbour(i, [&](int j, bool was, bool watched) {
            if (watched && !reconsider) return;
            const bool overlaps = boxes_[i].overlaps(boxes_[j]);
            const double room = std::abs(overlap(boxes_[i], boxes_[j]));
            if (watched ? calm(i, j, room) : overlaps != was) {
                set(i, j, overlaps, false);
                watched = false;
            }
            if (!watched) radius = std::min(radius, share(i, mine, j, overlaps, room));
        });
        regions_.radius[i] = ordinary(mine) ? rounded_down(radius) : -1.0F;
    }

    /// m: how far two boxes move in a step, together.
    double closing(int i, int j) const { return speed(i, seen(i)) + speed(j, seen(j)); }

    /// Whether a pair need not be watched any more. Twice the distance at which watching begins: a pair between the two
    /// would change sides at every look.
    bool calm(int i, int j, double room) const {
        return room > 2.0 * patience * closing(i, j) + guard_ && ordinary(reference(i)) && ordinary(reference(j));
    }

    // What the pair with j leaves i for its radius; infinite if the pair is better watched.
    double share(int i, const Box& mine, int j, bool overlaps, double room) {
        Box other = reference(j);
        if (!(room > patience * closing(i, j) && ordinary(mine) && ordinary(other))) return watch(i, j, overlaps);
        double certain = this->certain(mine, other, overlaps);
        const double taken = std::max(regions_.radius[j], 0.0F);
        if (certain - taken >= 0.5 * room) return certain - taken;
        // The region of j takes too much: it shrinks to a ball within itself, around where j is now.
        move_reference(j, seen(j));
        const double kept = regions_.radius[j] - farthest(reference(j), other) - guard_;
        other = reference(j);
        certain = this->certain(mine, other, overlaps);
        regions_.radius[j] = rounded_down(certain >= 0.0 ? std::min(kept, 0.5 * certain) : kept);
        if (!(certain >= 0.0)) return watch(i, j, overlaps);
        return certain - std::max(regions_.radius[j], 0.0F);
    }

    /// m: how much two boxes may change from their references before their pair can change; negative if it can at once.
    double certain(const Box& a, const Box& b, bool overlaps) const {
        const double o = overlap(a, b);
        return (o >= 0.0) == overlaps ? std::abs(o) - guard_ : -1.0;
    }

    double watch(int i, int j, bool overlaps) {
        set(i, j, overlaps, true);
        return std::numeric_limits<double>::infinity();
    }

    void compare_watched() {
        const auto watching = lists_.watching();
        const int words = static_cast<int>(watching.size());
        const int threads = n_ < 4000 ? 1 : thread_count();
#pragma omp parallel for schedule(static) num_threads(threads)
        for (int w = 0; w < words; ++w) talus::compare_watched(boxes_, w, lists_);
        for (int w = step_ % rest; w < words; w += rest)
            for (std::uint64_t left = watching[w]; left != 0; left &= left - 1) reconsider(64 * w + std::countr_zero(left));
    }

    void reconsider(int i) {
        for (const Neighbour n : lists_.watched_by(i))
            if (calm(i, n.box(), std::abs(overlap(boxes_[i], boxes_[n.box()])))) return look_at(i, true);
    }

    // ---- lists of neighbours -----------------------------------------------------------------------------------------

    // A hub is a box with very many neighbours, such as a base under a whole scene. It lists other hubs only; all others
    // list the hubs they meet, and the rare question who is near a hub goes through all boxes.
    bool stores(int i, int j) const { return !hub_[i] || hub_[j]; }

    /// Of the two of a pair, the one that watches it and tells of it.
    int keeper(int a, int b) const { return hub_[a] && !hub_[b] ? b : a; }

    void set(int i, int j, bool overlaps, bool watched) {
        const int watcher = watched ? keeper(std::min(i, j), std::max(i, j)) : -1;
        if (stores(i, j)) lists_.set(i, j, overlaps, watched, watcher == i);
        if (stores(j, i)) lists_.set(j, i, overlaps, watched, watcher == j);
    }

    template <class Visit>
    void for_each_neighbour(int i, Visit&& visit) {
        seen_.assign(lists_.of(i).begin(), lists_.of(i).end());  // what is set moves in the list
        for (const Neighbour n : seen_) visit(n.box(), n.overlaps(), n.watched());
        if (!hub_[i]) return;
        for (int j = 0; j < n_; ++j)
            if (!hub_[j])
                if (const Neighbour* n = lists_.find(j, i)) visit(j, n->overlaps(), n->watched());
    }

    void join(int i, int j) {
        const bool overlaps = boxes_[i].overlaps(boxes_[j]);
        if (stores(i, j)) lists_.add(i, Neighbour(j, overlaps, false));
        if (stores(j, i)) lists_.add(j, Neighbour(i, overlaps, false));
    }

    void part(int i, int j) {
        if (stores(i, j)) lists_.remove(i, j);
        if (stores(j, i)) lists_.remove(j, i);
    }

    /// Gives a box its coarse box anew, and the list that belongs to it.
    void list(int i, const Box& b) {
        const CoarseBox outer = coarse(b, margin(i, b));
        old_.clear();
        for_each_neighbour(i, [&](int j, bool, bool) { old_.push_back(j); });
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
            for_each_neighbour(i, [&](int j, bool, bool) { old_.push_back(j); });
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
                if (j != i) lists_.add(i, Neighbour(j, boxes_[i].overlaps(boxes_[j]), false));
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

    // Every pair gives half of its room to each of the two.
    void first_region(int i) {
        const Box mine = reference(i);
        double radius = slack(grid_.box(i), mine) - guard_;
        for_each_neighbour(i, [&](int j, bool overlaps, bool watched) {
            if (watched) return;
            const double room = certain(mine, reference(j), overlaps);
            if (room > patience * closing(i, j) && ordinary(mine) && ordinary(reference(j)))
                radius = std::min(radius, 0.5 * room);
            else
                watch(i, j, overlaps);
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
        guard_ = 0x1p-48 * (far_ + std::abs(centre_.x()) + std::abs(centre_.y()));
    }

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
    Vec2 centre_ = Vec2::Zero();
    double typical_ = 1.0;  // m, size of a box in the middle
    double far_ = 1.0;      // m, beyond it boxes are looked at in every step
    double guard_ = 0.0;    // m, more than all rounding of what is compared with a radius

    Regions regions_;
    std::vector<Track> track_;
    CellGrid grid_;  // coarse boxes
    NeighbourLists lists_;
    std::vector<char> hub_;

    std::vector<int> escaped_;
    std::vector<std::vector<int>> escaped_of_;  // by thread
    std::vector<int> old_;
    std::vector<Neighbour> seen_;
    std::int64_t looks_ = 0;
};

}  // namespace

std::unique_ptr<PairSearch> make_auto_search() { return std::make_unique<AutoSearch>(); }

}  // namespace talus
