#include "contact/end_order.hpp"

#include "contact/search.hpp"
#include "contact/sorted_ends.hpp"
#include "contact/vector_unit.hpp"

#include <algorithm>

namespace talus {
namespace {

constexpr std::size_t run = 16;  // ends looked at in one go

/// Brings whole runs of ends up to date, from `from` on, and stops before the first that is out of order, its coordinates
/// new as well. `coordinate`: of the boxes, four each, beginning at the lower end along this axis.
[[gnu::always_inline]] inline std::size_t refresh(const double* coordinate, const int* tag, double* at, std::size_t from,
                                                  std::size_t to) {
    for (; from + run <= to; from += run) {
        for (std::size_t k = from; k < from + run; ++k) at[k] = coordinate[2 * tag[k]];
        int disorder = 0;
        for (std::size_t k = from; k < from + run; ++k) disorder |= !(at[k - 1] < at[k]);
        if (disorder) break;
    }
    return from;
}

using Refresh = std::size_t (*)(const double*, const int*, double*, std::size_t, std::size_t);

std::size_t baseline(const double* coordinate, const int* tag, double* at, std::size_t from, std::size_t to) {
    return refresh(coordinate, tag, at, from, to);
}
#ifdef TALUS_VECTOR_UNITS
TALUS_AVX2 std::size_t avx2(const double* coordinate, const int* tag, double* at, std::size_t from, std::size_t to) {
    return refresh(coordinate, tag, at, from, to);
}
TALUS_AVX512 std::size_t avx512(const double* coordinate, const int* tag, double* at, std::size_t from, std::size_t to) {
    return refresh(coordinate, tag, at, from, to);
}
#endif

Refresh kernel([[maybe_unused]] VectorUnit unit) {
#ifdef TALUS_VECTOR_UNITS
    if (unit == VectorUnit::avx512) return avx512;
    if (unit == VectorUnit::avx2) return avx2;
#endif
    return baseline;
}

bool below(double at, int tag, double other_at, int other_tag) {
    if (at != other_at) return at < other_at;
    if ((tag ^ other_tag) & 1) return other_tag & 1;
    return tag < other_tag;
}

}  // namespace

void EndOrder::build(std::span<const Box> boxes) {
    struct Entry {
        double at;
        int tag;
    };
    std::vector<Entry> ends;
    ends.reserve(2 * boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (!present(boxes[i])) continue;
        const int tag = 2 * static_cast<int>(i);
        ends.push_back({axis_ == Axis::x ? boxes[i].xmin : boxes[i].ymin, tag});
        ends.push_back({axis_ == Axis::x ? boxes[i].xmax : boxes[i].ymax, tag + 1});
    }
    std::sort(ends.begin(), ends.end(), [](const Entry& a, const Entry& b) { return below(a.at, a.tag, b.at, b.tag); });
    at_.resize(ends.size());
    tag_.resize(ends.size());
    for (std::size_t k = 0; k < ends.size(); ++k) at_[k] = ends[k].at, tag_[k] = ends[k].tag;
}

bool EndOrder::repair(std::span<const Box> boxes, std::size_t from, std::size_t to, Crossings& crossings) {
    static const Refresh refresh = kernel(best_vector_unit());
    if (from == to) return true;
    const double* const coordinate = axis_ == Axis::x ? &boxes.front().xmin : &boxes.front().ymin;
    at_[from] = coordinate[2 * tag_[from]];
    for (std::size_t k = from + 1; k < to;) {
        k = refresh(coordinate, tag_.data(), at_.data(), k, to);
        for (const std::size_t end = std::min(k + run, to); k < end; ++k) {
            at_[k] = coordinate[2 * tag_[k]];
            if (sink(k, from, crossings) == Sunk::lost) return false;
        }
        if (!worth_it(crossings.exchanges, std::ssize(crossings.pairs))) return false;
    }
    return at_[from] == at_[from];
}

bool EndOrder::join(std::size_t at, std::size_t to, Crossings& crossings) {
    for (std::size_t k = at; k < to; ++k) {
        const Sunk sunk = sink(k, 0, crossings);
        if (sunk == Sunk::lost || !worth_it(crossings.exchanges, std::ssize(crossings.pairs))) return false;
        if (sunk == Sunk::no) break;  // those above it stay above it
    }
    return true;
}

bool EndOrder::worth_it(std::int64_t exchanges, std::int64_t crossings) const {
    return exchanges + SortedEnds::crossing_cost * crossings <= SortedEnds::worth_repairing(size() / 2);
}

/// Lets an end change places with those before it until it is in order.
EndOrder::Sunk EndOrder::sink(std::size_t place, std::size_t lowest, Crossings& crossings) {
    const double at = at_[place];
    const int tag = tag_[place];
    if (at != at) return Sunk::lost;
    std::size_t j = place;
    for (; j > lowest && below(at, tag, at_[j - 1], tag_[j - 1]); --j) {
        const int passed = tag_[j] = tag_[j - 1];
        at_[j] = at_[j - 1];
        const int differs = passed ^ tag;
        if ((differs & 1) == 0) continue;
        if (differs == 1) return Sunk::lost;  // the upper end of a box below its lower one
        crossings.pairs.push_back({std::min(passed, tag) / 2, std::max(passed, tag) / 2});
    }
    at_[j] = at;
    tag_[j] = tag;
    crossings.exchanges += static_cast<std::int64_t>(place - j);
    return j == place ? Sunk::no : Sunk::yes;
}

}  // namespace talus
