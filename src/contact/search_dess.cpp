// Double-ended spatial sorting, E. Perkins & J. R. Williams, Engineering Computations 18 (2001) 48-61, as published: the
// candidates of all boxes are gathered along x, and then struck out along y. In a plane packing they grow as N^1.5.
#include "contact/pair_set.hpp"
#include "contact/search_methods.hpp"
#include "contact/sorted_ends.hpp"

#include <algorithm>

namespace talus {
namespace {

class DessSearch final : public PairSearch {
public:
    void update(std::span<const Box> boxes) override {
        x_.bring_up_to_date(boxes);
        y_.bring_up_to_date(boxes);
        rank(x_, boxes.size(), rank_x_);
        rank(y_, boxes.size(), rank_y_);
        boxes_ = boxes.size();
        candidates_.clear();
        std::size_t struck = 0;
        for (int i = 0; i < static_cast<int>(boxes.size()); ++i) {
            if (present(boxes[i])) gather_along_x(i);
            if (candidates_.size() > struck + most_candidates) struck = strike_out_along_y(struck);
        }
        strike_out_along_y(struck);
    }

    void pairs(std::vector<Pair>& pairs) const override { sort_pairs(boxes_, candidates_, pairs); }

    std::int64_t exchanges() const override { return x_.exchanges() + y_.exchanges(); }

private:
    struct Ranks {
        int lower, upper;
    };

    // Those of 1e5 blocks of rock are 45 million. Beyond, they are struck out in rounds, or a million blocks would need more
    // memory than most machines have.
    static constexpr std::size_t most_candidates = std::size_t{1} << 26;

    static void rank(const SortedEnds& ends, std::size_t boxes, std::vector<Ranks>& ranks) {
        ranks.resize(boxes);
        for (std::size_t k = 0; k < ends.size(); ++k) {
            Ranks& of_box = ranks[ends[k].box];
            (ends[k].upper ? of_box.upper : of_box.lower) = static_cast<int>(k);
        }
    }

    /// Of two intervals that overlap, exactly one has the lower end of the other inside: counting lower ends only gives
    /// each pair once.
    void gather_along_x(int i) {
        for (int k = rank_x_[i].lower + 1; k < rank_x_[i].upper; ++k)
            if (!x_[k].upper) candidates_.push_back({std::min(i, x_[k].box), std::max(i, x_[k].box)});
    }

    /// Of the candidates from `from` on. Answers how many are left in all.
    std::size_t strike_out_along_y(std::size_t from) {
        const auto apart = [&](const Pair& pair) { return !overlap_along_y(pair.a, pair.b); };
        const auto first = candidates_.begin() + static_cast<std::ptrdiff_t>(from);
        candidates_.erase(std::remove_if(first, candidates_.end(), apart), candidates_.end());
        return candidates_.size();
    }

    /// Struck out only when the ranks are apart: a box that reaches over both of my ends has none of its own between them.
    bool overlap_along_y(int i, int j) const {
        const Ranks a = rank_y_[i], b = rank_y_[j];
        return a.lower < b.upper && b.lower < a.upper;
    }

    SortedEnds x_{&Box::xmin, &Box::xmax}, y_{&Box::ymin, &Box::ymax};
    std::vector<Ranks> rank_x_, rank_y_;  // [number of boxes] places in x_ and y_
    std::vector<Pair> candidates_;        // at the end of an update: the pairs
    std::size_t boxes_ = 0;
};

}  // namespace

std::unique_ptr<PairSearch> make_dess_search() { return std::make_unique<DessSearch>(); }

}  // namespace talus
