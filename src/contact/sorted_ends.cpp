#include "contact/sorted_ends.hpp"

#include <algorithm>

namespace talus {

void SortedEnds::build(std::span<const Box> boxes) {
    ends_.clear();
    listed_.assign(boxes.size(), 0);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (!present(boxes[i])) continue;
        listed_[i] = 1;
        ends_.push_back({boxes[i].*lower_, static_cast<int>(i), false});
        ends_.push_back({boxes[i].*upper_, static_cast<int>(i), true});
    }
    std::sort(ends_.begin(), ends_.end());
}

bool SortedEnds::lists_the_same(std::span<const Box> boxes) const {
    return std::equal(boxes.begin(), boxes.end(), listed_.begin(), listed_.end(),
                      [](const Box& box, char listed) { return present(box) == (listed != 0); });
}

std::vector<int> SortedEnds::tags() const {
    std::vector<int> tags;
    tags.reserve(ends_.size());
    for (const End& end : ends_) tags.push_back(2 * end.box + (end.upper ? 1 : 0));
    return tags;
}

}  // namespace talus
