#include "contact/pair_set.hpp"

#include <algorithm>

namespace talus {

FewIds::FewIds(FewIds&& other) noexcept : size_(other.size_), capacity_(other.capacity_) {
    if (capacity_ == few)
        std::copy_n(other.few_, few, few_);
    else
        many_ = other.many_;
    other.size_ = 0, other.capacity_ = few;
}

FewIds::~FewIds() {
    if (capacity_ > few) delete[] many_;
}

void FewIds::insert(int id) {
    int* const place = std::lower_bound(begin(), begin() + size_, id);
    if (place != begin() + size_ && *place == id) return;
    const auto before = place - begin();
    if (size_ == capacity_) grow();
    std::copy_backward(begin() + before, begin() + size_, begin() + size_ + 1);
    begin()[before] = id;
    ++size_;
}

void FewIds::erase(int id) {
    int* const last = begin() + size_;
    int* const place = std::lower_bound(begin(), last, id);
    if (place == last || *place != id) return;
    std::copy(place + 1, last, place);
    --size_;
}

void FewIds::grow() {
    int* const more = new int[2 * capacity_];
    std::copy_n(begin(), size_, more);
    if (capacity_ > few) delete[] many_;
    many_ = more;
    capacity_ *= 2;
}

void PairSet::assign(std::size_t boxes, std::span<const Pair> pairs) {
    std::vector<Pair> sorted;
    sort_pairs(boxes, pairs, sorted);
    larger_ = std::vector<FewIds>(boxes);
    for (const Pair& pair : sorted) insert(pair);  // in order: at the end of each list
}

void PairSet::list(std::vector<Pair>& pairs) const {
    std::size_t count = 0;
    for (const FewIds& ids : larger_) count += ids.size();
    pairs.resize(count);
    auto next = pairs.begin();
    for (std::size_t a = 0; a < larger_.size(); ++a)
        for (const int b : larger_[a]) *next++ = {static_cast<int>(a), b};
}

void sort_pairs(std::size_t boxes, std::span<const Pair> pairs, std::vector<Pair>& sorted) {
    std::vector<std::size_t> end(boxes + 1, 0);  // of the pairs of each box, once all are placed
    for (const Pair& pair : pairs) ++end[pair.a + 1];
    for (std::size_t a = 0; a < boxes; ++a) end[a + 1] += end[a];
    sorted.resize(pairs.size());
    for (const Pair& pair : pairs) sorted[end[pair.a]++] = pair;
    auto first = sorted.begin();
    for (std::size_t a = 0; a < boxes; ++a) {
        const auto last = sorted.begin() + static_cast<std::ptrdiff_t>(end[a]);
        std::sort(first, last);
        first = last;
    }
}

}  // namespace talus
