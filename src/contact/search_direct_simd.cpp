// All pairs, many at a time in vector registers. Nothing is remembered from call to call but the memory itself.
#include "contact/near_boxes.hpp"
#include "contact/pair_set.hpp"
#include "contact/search_methods.hpp"

#include <algorithm>
#include <array>

namespace talus {
namespace {

class DirectSimdSearch final : public PairSearch {
public:
    void update(std::span<const Box> boxes) override {
        const int count = static_cast<int>(boxes.size());
        boxes_ = boxes.size();
        rounded_.resize(boxes.size());
        for (int i = 0; i < count; ++i) rounded_.set(i, boxes[i]);
        pairs_.clear();
        for (int from = 0; from < count; from += tile)
            for (int a = 0; a < std::min(from + tile, count); ++a)
                compare(boxes, a, std::max(from, a + 1), std::min(from + tile, count));
    }

    void pairs(std::vector<Pair>& pairs) const override { sort_pairs(boxes_, pairs_, pairs); }

private:
    static constexpr int tile = 1024;  // boxes that stay in the nearest cache while all before them are compared with them

    void compare(std::span<const Box> boxes, int a, int from, int to) {
        const int near = find_near_(rounded_, a, from, to, near_.data());
        for (int k = 0; k < near; ++k) {
            const int b = near_[k];
            if (boxes[a].overlaps(boxes[b]) && present(boxes[a]) && present(boxes[b])) pairs_.push_back({a, b});
        }
    }

    const FindNear find_near_ = rarely_near_kernel(best_vector_unit());
    RoundedBoxes rounded_;
    std::array<int, tile + 16> near_;
    std::vector<Pair> pairs_;
    std::size_t boxes_ = 0;
};

}  // namespace

std::unique_ptr<PairSearch> make_direct_simd_search() { return std::make_unique<DirectSimdSearch>(); }

}  // namespace talus
