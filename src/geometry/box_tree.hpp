// Which boxes overlap a given one, or lie along a line: a balanced tree of boxes, built once. For setting a scene up and for
// questions about it; the search of contacts during a run is another matter (contact/search.hpp).
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
        where([&](const Box& box) { return box.overlaps(query); }, visit);
    }

    /// Calls visit(i) for every box i for which meets(box) holds. It must hold for every box that contains such a one.
    template <class Meets, class Visit>
    void where(Meets&& meets, Visit&& visit) const {
        descend(0, static_cast<int>(order_.size()), meets, visit);
    }

private:
    static constexpr int leaf = 8;  // 4 or 16 cost the same within a few percent

    // A node is a range of order_; a range longer than a leaf is split in the middle, and its box stands at the middle.
    template <class Meets, class Visit>
    void descend(int first, int last, Meets& meets, Visit& visit) const {
        if (last - first <= leaf) {
            for (int k = first; k < last; ++k)
                if (meets(boxes_[order_[k]])) visit(order_[k]);
            return;
        }
        const int middle = (first + last) / 2;
        if (!meets(bounds_[middle])) return;
        descend(first, middle, meets, visit);
        descend(middle, last, meets, visit);
    }
    void build(int first, int last);

    std::vector<Box> boxes_, bounds_;
    std::vector<int> order_;
};

}  // namespace talus
