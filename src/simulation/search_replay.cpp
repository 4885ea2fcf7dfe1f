#include "simulation/search_replay.hpp"

#include "simulation/threads.hpp"

#ifdef _OPENMP
#include <omp.h>
#endif

#include <bit>
#include <cstdint>

namespace talus {
namespace {

class ReadOnly final : public PairSearch {
public:
    void update(std::span<const Box> boxes) override {
        const auto n = 4 * static_cast<std::ptrdiff_t>(boxes.size());
        const double* const numbers = n > 0 ? &boxes[0].xmin : nullptr;
        std::uint64_t bits = 0;
#pragma omp parallel for simd schedule(static) reduction(| : bits) if (parallel : omp_get_max_threads() > 1)
        for (std::ptrdiff_t i = 0; i < n; ++i) bits |= std::bit_cast<std::uint64_t>(numbers[i]);
        bits_ = bits;
    }
    void pairs(std::vector<Pair>& pairs) const override { pairs.clear(); }

private:
    volatile std::uint64_t bits_ = 0;  // so that the loop is not left out
};

}  // namespace

std::unique_ptr<PairSearch> make_search_or_bound(const std::string& method) {
    if (method == "read") return std::make_unique<ReadOnly>();
    return make_search(method);
}

SearchReplay::SearchReplay(const MakeSearch& make, const std::string& method, int threads, double skin, std::size_t boxes)
    : threads_(threads), skin_(skin), grown_(skin > 0.0 ? boxes : 0) {
    use_my_threads();
    search_ = make(method);
}

void SearchReplay::use_my_threads() const { use_threads(threads_); }

bool SearchReplay::advance(std::span<const Box> boxes) {
    if (skin_ > 0.0) {
        if (!handed_.empty() && !left(boxes)) return false;
        grow(boxes);
        handed_ = grown_;
    } else {
        handed_ = boxes;
    }
    search_->update(handed_);
    return true;
}

bool SearchReplay::left(std::span<const Box> boxes) const {
    const auto n = static_cast<std::ptrdiff_t>(boxes.size());
    bool outside = false;
#pragma omp parallel for schedule(static) reduction(|| : outside) if (threads_ > 1)
    for (std::ptrdiff_t i = 0; i < n; ++i) {
        const Box &b = boxes[i], &g = grown_[i];
        if (b.xmin < g.xmin || b.ymin < g.ymin || b.xmax > g.xmax || b.ymax > g.ymax || present(b) != present(g))
            outside = true;
    }
    return outside;
}

void SearchReplay::grow(std::span<const Box> boxes) {
    const auto n = static_cast<std::ptrdiff_t>(boxes.size());
#pragma omp parallel for schedule(static) if (threads_ > 1)
    for (std::ptrdiff_t i = 0; i < n; ++i) grown_[i] = present(boxes[i]) ? boxes[i].grown(skin_) : boxes[i];
}

}  // namespace talus
