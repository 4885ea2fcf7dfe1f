// Incremental sort-and-update: A. Schinner, Fast algorithms for the simulation of polygonal particles,
// Granular Matter 2 (1999) 35-43; the same idea as sweep and prune (Cohen et al. 1995). The set of pairs is changed the
// moment two ends change places.
#include "contact/pair_set.hpp"
#include "contact/search_methods.hpp"
#include "contact/sorted_ends.hpp"
#include "contact/strip_sweep.hpp"

#include <algorithm>

namespace talus {
namespace {

class IsuSearch final : public PairSearch {
public:
    void update(std::span<const Box> boxes) override {
        if (!x_.lists_the_same(boxes) || !repair(x_, y_, boxes) || !repair(y_, x_, boxes)) rebuild(boxes);
    }

    void pairs(std::vector<Pair>& pairs) const override { pairs_.list(pairs); }

    std::int64_t exchanges() const override { return x_.exchanges() + y_.exchanges(); }

private:
    /// A lower end that slides below an upper one begins an overlap along this axis, an upper one that slides below a lower
    /// one ends it. The other axis is asked with its new coordinates, sorted yet or not: a pair that comes together or apart
    /// there changes places there, too, and is seen again.
    bool repair(SortedEnds& ends, const SortedEnds& other, std::span<const Box> boxes) {
        return ends.repair(boxes, [&](const End& passed, const End& moving) {
            const Pair pair{std::min(passed.box, moving.box), std::max(passed.box, moving.box)};
            if (moving.upper)
                pairs_.erase(pair);
            else if (other.overlap(boxes[pair.a], boxes[pair.b]))
                pairs_.insert(pair);
        });
    }

    void rebuild(std::span<const Box> boxes) {
        x_.build(boxes);
        y_.build(boxes);
        pairs_.assign(boxes.size(), strip_sweep(boxes, x_.tags(), y_.tags()));
    }

    SortedEnds x_{&Box::xmin, &Box::xmax}, y_{&Box::ymin, &Box::ymax};
    PairSet pairs_;
};

}  // namespace

std::unique_ptr<PairSearch> make_isu_search() { return std::make_unique<IsuSearch>(); }

}  // namespace talus
