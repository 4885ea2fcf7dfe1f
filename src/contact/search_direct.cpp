// All pairs, as the definition has it.
#include "contact/search_methods.hpp"

namespace talus {
namespace {

class DirectSearch final : public PairSearch {
public:
    void update(std::span<const Box> boxes) override {
        const int count = static_cast<int>(boxes.size());
        pairs_.clear();
        for (int a = 0; a < count; ++a)
            for (int b = a + 1; b < count; ++b)
                if (present(boxes[a]) && present(boxes[b]) && boxes[a].overlaps(boxes[b])) pairs_.push_back({a, b});
    }

    void pairs(std::vector<Pair>& pairs) const override { pairs = pairs_; }

private:
    std::vector<Pair> pairs_;
};

}  // namespace

std::unique_ptr<PairSearch> make_direct_search() { return std::make_unique<DirectSearch>(); }

}  // namespace talus
