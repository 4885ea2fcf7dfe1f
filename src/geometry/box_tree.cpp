#include "geometry/box_tree.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace talus {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr Box nothing{infinite, infinite, -infinite, -infinite};

Box around(const Box& a, const Box& b) {
    return {std::min(a.xmin, b.xmin), std::min(a.ymin, b.ymin), std::max(a.xmax, b.xmax), std::max(a.ymax, b.ymax)};
}

}  // namespace

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), bounds_(boxes_.size()), order_(boxes_.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    build(0, static_cast<int>(order_.size()));
}

void BoxTree::build(int first, int last) {
    if (last - first <= leaf) return;
    Box all = nothing;
    for (int k = first; k < last; ++k) all = around(all, boxes_[order_[k]]);
    const int middle = (first + last) / 2;
    bounds_[middle] = all;
    const bool wide = all.xmax - all.xmin > all.ymax - all.ymin;
    const auto centre = [&](int i) { return wide ? boxes_[i].xmin + boxes_[i].xmax : boxes_[i].ymin + boxes_[i].ymax; };
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last, [&](int i, int j) {
        const double ci = centre(i), cj = centre(j);
        return ci < cj || (ci == cj && i < j);
    });
    build(first, middle);
    build(middle, last);
}

}  // namespace talus
