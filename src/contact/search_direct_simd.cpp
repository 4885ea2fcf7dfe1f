// All pairs, many at a time in vector registers. Nothing is remembered from call to call but the memory itself.
#include "contact/pair_set.hpp"
#include "contact/search_methods.hpp"
#include "contact/vector_unit.hpp"

#include <algorithm>

namespace talus {
namespace {

// Overlaps are rare, so a run of boxes is asked at once whether it holds any. The runs of a tile stay in the nearest cache
// while all boxes before them are compared with it.
constexpr int run = 32, tile = 1024;

struct Bounds {
    const float *xmin, *ymin, *xmax, *ymax;  // m, rounded
};

/// The first run from `from` on, in steps of a run, that may hold a box that overlaps a; `to` if none does.
[[gnu::always_inline]] inline int next_near(const Bounds& of, int a, int from, int to) {
    const float x0 = of.xmin[a], y0 = of.ymin[a], x1 = of.xmax[a], y1 = of.ymax[a];
    for (; from < to; from += run) {
        int near = 0;
        for (int b = from; b < from + run; ++b)
            near |= (x0 <= of.xmax[b]) & (of.xmin[b] <= x1) & (y0 <= of.ymax[b]) & (of.ymin[b] <= y1);
        if (near) break;
    }
    return from;
}

using NextNear = int (*)(const Bounds&, int, int, int);

int baseline(const Bounds& of, int a, int from, int to) { return next_near(of, a, from, to); }
#ifdef TALUS_VECTOR_UNITS
TALUS_AVX2 int avx2(const Bounds& of, int a, int from, int to) { return next_near(of, a, from, to); }
TALUS_AVX512 int avx512(const Bounds& of, int a, int from, int to) { return next_near(of, a, from, to); }
#endif

NextNear kernel([[maybe_unused]] VectorUnit unit) {
#ifdef TALUS_VECTOR_UNITS
    if (unit == VectorUnit::avx512) return avx512;
    if (unit == VectorUnit::avx2) return avx2;
#endif
    return baseline;
}

class DirectSimdSearch final : public PairSearch {
public:
    void update(std::span<const Box> boxes) override {
        const int count = static_cast<int>(boxes.size());
        round(boxes);
        boxes_ = boxes.size();
        pairs_.clear();
        for (int from = 0; from < count; from += tile)
            for (int a = 0; a < std::min(from + tile, count); ++a) compare(boxes, a, from, std::min(from + tile, count));
    }

    void pairs(std::vector<Pair>& pairs) const override { sort_pairs(boxes_, pairs_, pairs); }

private:
    /// Rounding keeps order (x <= y gives float(x) <= float(y)): boxes that overlap do so after rounding as well. The last
    /// run is filled up with boxes that overlap nothing.
    void round(std::span<const Box> boxes) {
        const std::size_t whole_runs = (boxes.size() + run - 1) / run * run;
        for (auto* side : {&xmin_, &ymin_, &xmax_, &ymax_})
            side->assign(whole_runs, std::numeric_limits<float>::quiet_NaN());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            xmin_[i] = static_cast<float>(boxes[i].xmin);
            ymin_[i] = static_cast<float>(boxes[i].ymin);
            xmax_[i] = static_cast<float>(boxes[i].xmax);
            ymax_[i] = static_cast<float>(boxes[i].ymax);
        }
    }

    void compare(std::span<const Box> boxes, int a, int from, int to) {
        if (!present(boxes[a])) return;
        const Bounds rounded{xmin_.data(), ymin_.data(), xmax_.data(), ymax_.data()};
        from = std::max(from, (a + 1) / run * run);
        for (int next = next_near_(rounded, a, from, to); next < to; next = next_near_(rounded, a, next + run, to))
            for (int b = std::max(next, a + 1); b < std::min(next + run, to); ++b)
                if (boxes[a].overlaps(boxes[b]) && present(boxes[b])) pairs_.push_back({a, b});
    }

    NextNear next_near_ = kernel(best_vector_unit());
    std::vector<float> xmin_, ymin_, xmax_, ymax_;  // [number of boxes, up to a whole run] m, rounded
    std::vector<Pair> pairs_;
    std::size_t boxes_ = 0;
};

}  // namespace

std::unique_ptr<PairSearch> make_direct_simd_search() { return std::make_unique<DirectSimdSearch>(); }

}  // namespace talus
