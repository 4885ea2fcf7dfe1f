// Double-ended spatial sorting, E. Perkins & J. R. Williams, Engineering Computations 18 (2001) 48-61.
// The method gathers the candidates of all boxes along x and strikes out along y. Here both are done box by box, which
// gives the same pairs and spares the set of all candidates: in a plane packing it grows as N^1.5.
#include "contact/search_methods.hpp"
#include "contact/sorted_ends.hpp"

#include <algorithm>

namespace talus {
namespace {

class DessSearch final : public PairSearch {
public:
    void update(std::span<const Box> boxes) override {
        sort(boxes);
        rank(x_, boxes.size(), rank_x_);
        rank(y_, boxes.size(), rank_y_);
        pairs_.clear();
        for (int i = 0; i < static_cast<int>(boxes.size()); ++i) {
            if (!present(boxes[i])) continue;
            gather_along_x(i);
            for (const int j : candidates_)
                if (overlap_along_y(i, j)) pairs_.push_back({std::min(i, j), std::max(i, j)});
        }
        std::sort(pairs_.begin(), pairs_.end());
    }

    void pairs(std::vector<Pair>& pairs) const override { pairs = pairs_; }

private:
    struct Ranks {
        int lower, upper;
    };

    void sort(std::span<const Box> boxes) {
        const auto nothing = [](int, int) {};
        const bool same = x_.lists_the_same(boxes);
        for (SortedEnds* ends : {&x_, &y_}) {
            std::int64_t budget = SortedEnds::worth_repairing(boxes);
            if (!same || !ends->repair(boxes, budget, nothing)) ends->build(boxes);
        }
    }

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
        const Ranks mine = rank_x_[i];
        candidates_.resize(mine.upper - mine.lower);
        std::size_t found = 0;
        for (int k = mine.lower + 1; k < mine.upper; ++k) {
            candidates_[found] = x_[k].box;  // kept by the next line; a branch here would be a coin toss
            found += !x_[k].upper;
        }
        candidates_.resize(found);
    }

    /// Struck out only when the ranks are apart: a box that reaches over both of my ends has none of its own between them.
    bool overlap_along_y(int i, int j) const {
        const Ranks a = rank_y_[i], b = rank_y_[j];
        return (a.lower < b.upper) & (b.lower < a.upper);
    }

    SortedEnds x_{&Box::xmin, &Box::xmax}, y_{&Box::ymin, &Box::ymax};
    std::vector<Ranks> rank_x_, rank_y_;  // [number of boxes] places in x_ and y_
    std::vector<int> candidates_;
    std::vector<Pair> pairs_;
};

}  // namespace

std::unique_ptr<PairSearch> make_dess_search() { return std::make_unique<DessSearch>(); }

}  // namespace talus
