#include "simulation/search_replay.hpp"

#include "simulation/threads.hpp"

#ifdef _OPENMP
#include <omp.h>
#endif

#include <algorithm>
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

// Without branches, two coordinates at a time: it is all that most steps with a skin cost.
bool SearchReplay::left(std::span<const Box> boxes) const {
    const auto n = static_cast<std::ptrdiff_t>(boxes.size());
    const Eigen::Array4d inward(1.0, 1.0, -1.0, -1.0);
    double deepest = 0.0;       // m, < 0 if some side lies outside the grown one
    std::int64_t vanished = 0;  // or come back, which the sides show as well
#pragma omp parallel reduction(min : deepest) reduction(+ : vanished) if (threads_ > 1)
    {
        Eigen::Array4d inside = Eigen::Array4d::Zero();
#pragma omp for schedule(static)
        for (std::ptrdiff_t i = 0; i < n; ++i) {
            const Eigen::Map<const Eigen::Array4d> now(&boxes[i].xmin), grown(&grown_[i].xmin);
            inside = inside.min((now - grown) * inward);
            vanished += (boxes[i].xmin <= boxes[i].xmax) != (grown_[i].xmin <= grown_[i].xmax);
        }
        deepest = std::min(deepest, inside.minCoeff());
    }
    return deepest < 0.0 || vanished > 0;
}

void SearchReplay::grow(std::span<const Box> boxes) {
    const auto n = static_cast<std::ptrdiff_t>(boxes.size());
#pragma omp parallel for schedule(static) if (threads_ > 1)
    for (std::ptrdiff_t i = 0; i < n; ++i) grown_[i] = present(boxes[i]) ? boxes[i].grown(skin_) : boxes[i];
}

}  // namespace talus
