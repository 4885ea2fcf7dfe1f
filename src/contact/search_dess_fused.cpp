// Double-ended spatial sorting, E. Perkins & J. R. Williams, Engineering Computations 18 (2001) 48-61, with its two halves
// fused: what is gathered along x for one box is struck out along y at once, many candidates at a time in vector registers.
// The set of all candidates is never stored, and the order along y is not needed.
#include "contact/near_boxes.hpp"
#include "contact/pair_set.hpp"
#include "contact/search_methods.hpp"
#include "contact/sorted_ends.hpp"

#include <algorithm>

namespace talus {
namespace {

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
    /// inside, so the candidates of the box at place i are those at the places (i, until_[i]).
    void rank(std::span<const Box> boxes) {
        const std::size_t count = x_.size() / 2;
        order_.clear();
        place_.resize(boxes.size());
        until_.resize(count);
        rounded_.resize(count);
        near_.resize(count + 16);
        for (std::size_t k = 0; k < x_.size(); ++k) {
            const int box = x_[k].box, next = static_cast<int>(order_.size());
            if (x_[k].upper) {
                until_[place_[box]] = next;
                continue;
            }
            place_[box] = next;
            rounded_.set(next, boxes[box]);
            order_.push_back(box);
        }
    }

    void strike_out_along_y(std::span<const Box> boxes, int i) {
        const int near = find_near_(rounded_, i, i + 1, until_[i], near_.data());
        const Box& mine = boxes[order_[i]];
        for (int k = 0; k < near; ++k) {
            const int other = order_[near_[k]];
            if ((mine.ymin <= boxes[other].ymax) & (boxes[other].ymin <= mine.ymax))
                pairs_.push_back({std::min(order_[i], other), std::max(order_[i], other)});
        }
    }

    const FindNear find_near_ = near_along_y_kernel(best_vector_unit());
    SortedEnds x_{&Box::xmin, &Box::xmax};
    std::vector<int> order_, until_;  // [number of boxes present], by the lower ends along x
    std::vector<int> place_;          // [number of boxes] in order_
    RoundedBoxes rounded_;            // [number of boxes present], in the same order
    std::vector<int> near_;
    std::vector<Pair> pairs_;
    std::size_t boxes_ = 0;
};

}  // namespace

std::unique_ptr<PairSearch> make_dess_fused_search() { return std::make_unique<DessFusedSearch>(); }

}  // namespace talus
