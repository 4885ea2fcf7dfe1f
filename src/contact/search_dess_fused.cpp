// Double-ended spatial sorting, E. Perkins & J. R. Williams, Engineering Computations 18 (2001) 48-61, with its two halves
// fused: what is gathered along x for one box is struck out along y at once, many candidates at a time in vector registers.
// The set of all candidates is never stored, and the order along y is not needed.
#include "contact/pair_set.hpp"
#include "contact/search_methods.hpp"
#include "contact/sorted_ends.hpp"
#include "contact/vector_unit.hpp"

#include <algorithm>
#include <limits>

namespace talus {
namespace {

constexpr int run = 16;  // candidates asked at once: most runs hold no pair

/// The first run from `from` on, in steps of a run, that may hold a candidate whose interval along y meets [y0, y1]; beyond
/// `to` if none does.
[[gnu::always_inline]] inline int next_near(const float* ymin, const float* ymax, float y0, float y1, int from, int to) {
    for (; from < to; from += run) {
        int near = 0;
        for (int k = from; k < from + run; ++k) near |= (y0 <= ymax[k]) & (ymin[k] <= y1);
        if (near) break;
    }
    return from;
}

using NextNear = int (*)(const float*, const float*, float, float, int, int);

int baseline(const float* ymin, const float* ymax, float y0, float y1, int from, int to) {
    return next_near(ymin, ymax, y0, y1, from, to);
}
#ifdef TALUS_VECTOR_UNITS
TALUS_AVX2 int avx2(const float* ymin, const float* ymax, float y0, float y1, int from, int to) {
    return next_near(ymin, ymax, y0, y1, from, to);
}
TALUS_AVX512 int avx512(const float* ymin, const float* ymax, float y0, float y1, int from, int to) {
    return next_near(ymin, ymax, y0, y1, from, to);
}
#endif

NextNear kernel([[maybe_unused]] VectorUnit unit) {
#ifdef TALUS_VECTOR_UNITS
    if (unit == VectorUnit::avx512) return avx512;
    if (unit == VectorUnit::avx2) return avx2;
#endif
    return baseline;
}

class DessFusedSearch final : public PairSearch {
public:
    void update(std::span<const Box> boxes) override {
        x_.bring_up_to_date(boxes);
        boxes_ = boxes.size();
        pairs_.clear();
        rank(boxes);
        for (int i = 0; i < static_cast<int>(order_.size()); ++i) strike_out_along_y(boxes, i);
    }

    void pairs(std::vector<Pair>& pairs) const override { sort_pairs(boxes_, pairs_, pairs); }

    std::int64_t exchanges() const override { return x_.exchanges(); }

private:
    /// Boxes in the order of their lower ends along x; of two that overlap along x, one has the lower end of the other
    /// inside, so the candidates of the box at place i are those at the places (i, until_[i]). Rounding keeps order: boxes
    /// that overlap do so after rounding as well.
    void rank(std::span<const Box> boxes) {
        const std::size_t count = x_.size() / 2;
        order_.clear();
        place_.resize(boxes.size());
        until_.resize(count);
        ymin_.assign(count + run, std::numeric_limits<float>::quiet_NaN());  // so that a run may reach beyond the end
        ymax_.assign(count + run, std::numeric_limits<float>::quiet_NaN());
        for (std::size_t k = 0; k < x_.size(); ++k) {
            const int box = x_[k].box, next = static_cast<int>(order_.size());
            if (x_[k].upper) {
                until_[place_[box]] = next;
                continue;
            }
            place_[box] = next;
            ymin_[next] = static_cast<float>(boxes[box].ymin);
            ymax_[next] = static_cast<float>(boxes[box].ymax);
            order_.push_back(box);
        }
    }

    void strike_out_along_y(std::span<const Box> boxes, int i) {
        const int to = until_[i];
        const Box& mine = boxes[order_[i]];
        const auto next_near = [&](int from) {
            return next_near_(ymin_.data(), ymax_.data(), ymin_[i], ymax_[i], from, to);
        };
        for (int next = next_near(i + 1); next < to; next = next_near(next + run))
            for (int k = next; k < std::min(next + run, to); ++k) {
                const Box& other = boxes[order_[k]];
                if ((mine.ymin <= other.ymax) & (other.ymin <= mine.ymax))
                    pairs_.push_back({std::min(order_[i], order_[k]), std::max(order_[i], order_[k])});
            }
    }

    NextNear next_near_ = kernel(best_vector_unit());
    SortedEnds x_{&Box::xmin, &Box::xmax};
    std::vector<int> order_, until_;  // [number of boxes present], by the lower ends along x
    std::vector<int> place_;          // [number of boxes] in order_
    std::vector<float> ymin_, ymax_;  // [number of boxes present, and a run] m, rounded, in the same order
    std::vector<Pair> pairs_;
    std::size_t boxes_ = 0;
};

}  // namespace

std::unique_ptr<PairSearch> make_dess_fused_search() { return std::make_unique<DessFusedSearch>(); }

}  // namespace talus
