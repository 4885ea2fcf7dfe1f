// Which boxes overlap a given one: a balanced tree of boxes, built once. For setting a scene up; the search of contacts
// during a run is another matter (contact/search.hpp).
#pragma once

#include "core/types.hpp"

#include <vector>

namespace talus {

class BoxTree {
public:
    explicit BoxTree(std::vector<Box> boxes);

    /// Calls visit(i) for every box i that overlaps `query` (touching counts), each once, in no useful order.
    template <class Visit>
    void overlapping(const Box& query, Visit&& visit) const {
        descend(0, static_cast<int>(order_.size()), query, visit);
    }

private:
    static constexpr int leaf = 8;  // 4 or 16 cost the same within a few percent

    // A node is a range of order_; a range longer than a leaf is split in the middle, and its box stands at the middle.
    template <class Visit>
    void descend(int first, int last, const Box& query, Visit& visit) const {
        if (last - first <= leaf) {
            for (int k = first; k < last; ++k)
                if (boxes_[order_[k]].overlaps(query)) visit(order_[k]);
            return;
        }
        const int middle = (first + last) / 2;
        if (!bounds_[middle].overlaps(query)) return;
        descend(first, middle, query, visit);
        descend(middle, last, query, visit);
    }
    void build(int first, int last);

    std::vector<Box> boxes_, bounds_;
    std::vector<int> order_;
};

}  // namespace talus
