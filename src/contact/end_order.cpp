#include "contact/end_order.hpp"

#include "contact/end_disorder.hpp"
#include "contact/search.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace talus {
namespace {

/// The order of ends at a and b, with tags t and u.
bool below(double a, int t, double b, int u) {
    if (a != b) return a < b;
    if ((t ^ u) & 1) return u & 1;
    return t < u;
}

struct Keyed {
    std::uint64_t key;
    int tag;
};

/// Whole numbers in the order of the doubles; both zeros are one.
std::uint64_t key(double at) {
    const auto bits = std::bit_cast<std::uint64_t>(at + 0.0);
    return bits >> 63 ? ~bits : bits | std::uint64_t{1} << 63;
}

/// By digits, the lowest first: each pass keeps the order of equal ones.
void sort(std::vector<Keyed>& ends) {
    constexpr int digit_bits = 11, digits = 6;
    std::vector<std::array<int, 1 << digit_bits>> count(digits);
    const auto digit = [](std::uint64_t of, int d) { return of >> (d * digit_bits) & ((1 << digit_bits) - 1); };
    for (const Keyed& end : ends)
        for (int d = 0; d < digits; ++d) ++count[d][digit(end.key, d)];
    std::vector<Keyed> sorted(ends.size());
    for (int d = 0; d < digits; ++d) {
        if (std::ranges::count(count[d], 0) == (1 << digit_bits) - 1) continue;  // the same in all
        int place = 0;
        for (int& of_digit : count[d]) place += std::exchange(of_digit, place);
        for (const Keyed& end : ends) sorted[count[d][digit(end.key, d)]++] = end;
        ends.swap(sorted);
    }
}

}  // namespace

const double* EndOrder::coordinates(std::span<const Box> boxes) const {
    return axis_ == Axis::x ? &boxes.front().xmin : &boxes.front().ymin;
}

void EndOrder::build(std::span<const Box> boxes) {
    std::vector<Keyed> ends;
    ends.reserve(2 * boxes.size());
    for (const int upper : {0, 1})
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const int tag = 2 * static_cast<int>(i) + upper;
            if (present(boxes[i])) ends.push_back({key(coordinates(boxes)[2 * tag]), tag});
        }
    sort(ends);
    tag_.resize(ends.size());
    for (std::size_t k = 0; k < ends.size(); ++k) tag_[k] = ends[k].tag;
}

bool EndOrder::repair(std::span<const Box> boxes, int from, int to, Crossings& met) {
    static const FindDisorder find_disorder = disorder_kernel(best_vector_unit());
    if (from == to) return true;
    const double* const coordinate = coordinates(boxes);
    const double first = coordinate[2 * tag_[from]];
    if (first != first) return false;
    // Block by block, so that what was looked at is still near when it is set right; half or twice as many cost the same.
    constexpr int block = 512;
    std::array<int, block + 8> places;
    int done = from;  // up to here the ends are in order
    for (int next = from + 1; next < to; next += block) {
        const int found = find_disorder(coordinate, tag_.data(), next, std::min(next + block, to), places.data());
        for (int i = 0; i < found; ++i) {
            if (places[i] <= done) continue;  // in a row of equal coordinates every place was found
            for (int place = places[i]; place < to; ++place) {
                const Sunk sunk = sink(coordinate, place, from, met);
                if (sunk == Sunk::lost || !worth_it(met.exchanges, static_cast<std::int64_t>(met.noted))) return false;
                done = place;
                // The end that is here now is above the one that was: the next one may be below it.
                if (place + 1 == to || coordinate[2 * tag_[place]] < coordinate[2 * tag_[place + 1]]) break;
            }
        }
    }
    sort_out(boxes, met);
    return true;
}

bool EndOrder::join(std::span<const Box> boxes, int at, int to, Crossings& met) {
    for (int k = at; k < to; ++k) {
        const Sunk sunk = sink(coordinates(boxes), k, 0, met);
        if (sunk == Sunk::lost || !worth_it(met.exchanges, static_cast<std::int64_t>(met.noted))) return false;
        if (sunk == Sunk::no) break;  // those above it stay above it
    }
    sort_out(boxes, met);
    return true;
}

bool EndOrder::worth_it(std::int64_t exchanges, std::int64_t crossings) const {
    return exchanges + crossing_cost * crossings <= worth_repairing * (size() / 2);
}

/// Lets an end change places with those before it until it is in order. Whether it crosses those it passes is as good as a
/// coin toss: no branch asks for it.
EndOrder::Sunk EndOrder::sink(const double* coordinate, int place, int lowest, Crossings& met) {
    const int moving = tag_[place];
    const double at = coordinate[2 * moving];
    if (at != at) return Sunk::lost;
    int to = place;
    while (to > lowest && below(at, moving, coordinate[2 * tag_[to - 1]], tag_[to - 1])) --to;
    if (to == place) return Sunk::no;

    if (met.noted + place - to > met.crossed.size()) met.crossed.resize(2 * (met.noted + place - to));
    Crossings::Crossing* next = met.crossed.data() + met.noted;
    int nearest = 2;
    for (int k = place; k > to; --k) {
        const int passed = tag_[k] = tag_[k - 1], differs = passed ^ moving;
        *next = {passed, moving};
        next += differs & 1;
        nearest = std::min(nearest, differs);
    }
    tag_[to] = moving;
    met.noted = next - met.crossed.data();
    met.exchanges += place - to;
    return nearest == 1 ? Sunk::lost : Sunk::yes;  // lost: the upper end of a box below its lower one
}

/// A lower end that slides below an upper one begins an overlap along this axis: the boxes were apart, and are a new pair if
/// they overlap now. An upper end that slides below a lower one ends it: they may have been a pair. Of those that came
/// apart along both axes at once, the list along y notes all; so the one along x may leave them out.
void EndOrder::sort_out(std::span<const Box> boxes, Crossings& met) const {
    met.begun.resize(met.noted);
    met.ended.resize(met.noted);
    Pair *begun = met.begun.data(), *ended = met.ended.data();
    for (std::size_t k = 0; k < met.noted; ++k) {
        const auto [passed, moving] = met.crossed[k];
        const Pair pair{std::min(passed, moving) / 2, std::max(passed, moving) / 2};
        const Box &a = boxes[pair.a], &b = boxes[pair.b];
        const bool x = (a.xmin <= b.xmax) & (b.xmin <= a.xmax), y = (a.ymin <= b.ymax) & (b.ymin <= a.ymax);
        const bool ends = moving & 1;
        *begun = *ended = pair;
        begun += !ends & x & y;
        ended += ends & (y | (axis_ == Axis::y));
    }
    met.begun.resize(begun - met.begun.data());
    met.ended.resize(ended - met.ended.data());
    met.crossings = static_cast<std::int64_t>(met.noted);
}

}  // namespace talus
