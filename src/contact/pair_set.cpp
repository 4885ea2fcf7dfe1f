#include "contact/pair_set.hpp"

#include <algorithm>
#include <span>
#include <utility>

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

Pair* FewIds::write(int a, Pair* to) const {
    if (capacity_ == few)
        for (int i = 0; i < few; ++i) to[i] = {a, few_[i]};
    else
        for (int i = 0; i < size_; ++i) to[i] = {a, many_[i]};
    return to + size_;
}

/// How many are below. In the usual case without a branch: a search would guess wrong at each of its steps.
int FewIds::below(int id) const {
    if (capacity_ != few) return static_cast<int>(std::lower_bound(many_, many_ + size_, id) - many_);
    int count = 0;
    for (int i = 0; i < few; ++i) count += (i < size_) & (few_[i] < id);
    return count;
}

void FewIds::insert(int id) {
    const int place = below(id);
    if (place < size_ && begin()[place] == id) return;
    if (size_ == capacity_) grow();
    int* const ids = begin();
    std::copy_backward(ids + place, ids + size_, ids + size_ + 1);
    ids[place] = id;
    ++size_;
}

void FewIds::erase(int id) {
    const int place = below(id);
    int* const ids = begin();
    if (place == size_ || ids[place] != id) return;
    std::copy(ids + place + 1, ids + size_, ids + place);
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
    pairs.resize(count + FewIds::few);
    Pair* next = pairs.data();
    for (std::size_t a = 0; a < larger_.size(); ++a) next = larger_[a].write(static_cast<int>(a), next);
    pairs.resize(count);
}

namespace {

constexpr int many = 32;  // where comparing all with all begins to cost more

void insertion_sort(std::span<Pair> of_one_box) {
    for (std::size_t k = 1; k < of_one_box.size(); ++k) {
        const Pair next = of_one_box[k];
        std::size_t to = k;
        for (; to > 0 && of_one_box[to - 1].b > next.b; --to) of_one_box[to] = of_one_box[to - 1];
        of_one_box[to] = next;
    }
}

}  // namespace

void sort_pairs(std::size_t boxes, std::span<const Pair> pairs, std::vector<Pair>& sorted) {
    std::vector<int> place(boxes);
    for (const Pair& pair : pairs) ++place[pair.a];
    for (int next = 0; int& first : place) next += std::exchange(first, next);
    sorted.resize(pairs.size());
    for (const Pair& pair : pairs) sorted[place[pair.a]++] = pair;
    int begin = 0;
    for (const int end : place) {  // a few each, but those of a hub
        if (end - begin > many)
            std::sort(sorted.begin() + begin, sorted.begin() + end, [](Pair x, Pair y) { return x.b < y.b; });
        else
            insertion_sort({sorted.data() + begin, sorted.data() + end});
        begin = end;
    }
}

}  // namespace talus
