// Incremental sort-and-update: A. Schinner, Fast algorithms for the simulation of polygonal particles,
// Granular Matter 2 (1999) 35-43; the same idea as sweep and prune (Cohen et al. 1995).
#include "contact/search_methods.hpp"
#include "contact/sorted_ends.hpp"

#include <algorithm>

namespace talus {
namespace {

class IsuSearch final : public PairSearch {
public:
    void update(std::span<const Box> boxes) override {
        if (x_.lists_the_same(boxes) && repair(boxes))
            merge(boxes);
        else
            rebuild(boxes);
        last_.assign(boxes.begin(), boxes.end());
    }

    void pairs(std::vector<Pair>& pairs) const override { pairs = pairs_; }

private:
    /// Puts down every pair that may have come together or apart. Along x the test on the other axis uses the y of the last
    /// call, along y the new x. A pair that is new, or gone, changed along x while its old y overlapped, or along y while
    /// its new x does, and an overlap along an axis changes only when a lower end passes an upper one: none is missed.
    bool repair(std::span<const Box> boxes) {
        touched_.clear();
        const auto put_down = [&](const SortedEnds& other, std::span<const Box> at, int i, int j) {
            if (other.overlap(at[i], at[j])) touched_.push_back({std::min(i, j), std::max(i, j)});
        };
        std::int64_t budget = SortedEnds::worth_repairing(boxes);
        return x_.repair(boxes, budget, [&](int i, int j) { put_down(y_, last_, i, j); }) &&
               y_.repair(boxes, budget, [&](int i, int j) { put_down(x_, boxes, i, j); });
    }

    /// Merges the touched pairs into the sorted list: each is in it afterwards if it overlaps now, and out if not. None
    /// enters twice: a pair that overlaps now and did not before was apart along y, or along x only, and was put down there,
    /// once; twice in the buffer are only pairs that jumped past each other.
    void merge(std::span<const Box> boxes) {
        if (touched_.empty()) return;
        std::sort(touched_.begin(), touched_.end());
        merged_.clear();
        auto rest = pairs_.cbegin();
        for (const Pair& pair : touched_) {
            const auto place = std::lower_bound(rest, pairs_.cend(), pair);
            merged_.insert(merged_.end(), rest, place);
            rest = place != pairs_.cend() && *place == pair ? place + 1 : place;
            const Box &a = boxes[pair.a], &b = boxes[pair.b];
            if (a.overlaps(b)) merged_.push_back(pair);
        }
        merged_.insert(merged_.end(), rest, pairs_.cend());
        pairs_.swap(merged_);
    }

    void rebuild(std::span<const Box> boxes) {
        x_.build(boxes);
        y_.build(boxes);
        // A column or a layer of blocks overlaps almost wholly along one axis: sweep along the other.
        const bool along_x = overlaps_along(x_) <= overlaps_along(y_);
        pairs_.clear();
        along_x ? sweep(x_, y_, boxes) : sweep(y_, x_, boxes);
        std::sort(pairs_.begin(), pairs_.end());
    }

    static std::int64_t overlaps_along(const SortedEnds& ends) {
        std::int64_t open = 0, overlaps = 0;
        for (const End& end : ends) {
            if (!end.upper) overlaps += open;
            open += end.upper ? -1 : 1;
        }
        return overlaps;
    }

    /// A box meets those whose interval begins inside its own.
    void sweep(const SortedEnds& along, const SortedEnds& other, std::span<const Box> boxes) {
        for (auto end = along.begin(); end != along.end(); ++end) {
            if (end->upper) continue;
            for (auto next = end + 1; next->box != end->box; ++next)
                if (!next->upper & other.overlap(boxes[end->box], boxes[next->box]))
                    pairs_.push_back({std::min(end->box, next->box), std::max(end->box, next->box)});
        }
    }

    SortedEnds x_{&Box::xmin, &Box::xmax}, y_{&Box::ymin, &Box::ymax};
    std::vector<Box> last_;               // boxes of the last call
    std::vector<Pair> pairs_;             // overlapping in the last call, sorted
    std::vector<Pair> touched_, merged_;  // buffers
};

}  // namespace

std::unique_ptr<PairSearch> make_isu_search() { return std::make_unique<IsuSearch>(); }

}  // namespace talus
