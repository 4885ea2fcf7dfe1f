// Incremental sort-and-update (see search_isu.cpp) with the update separated from the sort: first both lists of ends are put
// in order, and the pairs whose ends changed places are put down; then each of them is looked at once. A pair that comes and
// goes within a step never enters the set, the lists can be sorted at the same time and in chunks, and the set can be
// changed by several threads, each with the pairs that its own boxes own: nothing is locked, nothing depends on who was
// first.
#include "contact/end_order.hpp"
#include "contact/pair_set.hpp"
#include "contact/search_methods.hpp"
#include "contact/strip_sweep.hpp"
#include "contact/threads.hpp"

#include <algorithm>
#include <array>
#include <atomic>

namespace talus {
namespace {

class SeparatedIsuSearch final : public PairSearch {
public:
    explicit SeparatedIsuSearch(bool parallel) : parallel_(parallel) {}

    void update(std::span<const Box> boxes) override {
        if (!lists_the_same(boxes) || !repair(boxes)) rebuild(boxes);
    }

    void pairs(std::vector<Pair>& pairs) const override { pairs_.list(pairs); }

    std::int64_t exchanges() const override { return exchanges_; }

private:
    static constexpr std::size_t worth_sharing = 1000;  // boxes; fewer are done before the threads have started

    /// Whether none has come. Boxes that are gone are met by the repair.
    bool lists_the_same(std::span<const Box> boxes) const {
        return boxes.size() == boxes_ &&
               std::none_of(absent_.begin(), absent_.end(), [&](int i) { return present(boxes[i]); });
    }

    bool repair(std::span<const Box> boxes) {
        [[maybe_unused]] const int threads = parallel_ && boxes.size() >= worth_sharing ? threads_allowed() : 1;
        // two lists in as many chunks as give all threads the same number of them
        const int chunks = threads == 1 ? 1 : threads % 2 == 0 ? threads / 2 : threads;
        met_.resize(2 * (chunks + 1));
        for (Crossings& met : met_) met.clear();
        std::atomic<bool> lost = false;
#pragma omp parallel num_threads(threads) if (threads > 1)
        {
#pragma omp for schedule(static)
            for (int task = 0; task < 2 * chunks; ++task) {
                EndOrder& list = list_[task / chunks];
                const int chunk = task % chunks;
                if (!list.repair(boxes, place(list, chunk, chunks), place(list, chunk + 1, chunks), met_[task])) lost = true;
            }
#pragma omp for schedule(static)
            for (int axis = 0; axis < 2; ++axis)
                if (!lost && !join(boxes, axis, chunks)) lost = true;
#pragma omp for schedule(static)
            for (int part = 0; part < threads; ++part)
                if (!lost) update_part(boxes.size(), part, threads);
        }
        if (!lost)
            for (const Crossings& met : met_) exchanges_ += met.exchanges;
        return !lost;
    }

    static int place(const EndOrder& list, int chunk, int chunks) {
        return static_cast<int>(std::int64_t{list.size()} * chunk / chunks);
    }

    /// Puts the chunks of a list in order among each other. What is worth it is asked of all chunks together, so that the
    /// answer is the same for any number of them.
    bool join(std::span<const Box> boxes, int axis, int chunks) {
        EndOrder& list = list_[axis];
        Crossings& met = met_[2 * chunks + axis];
        for (int chunk = 1; chunk < chunks; ++chunk)
            if (!list.join(boxes, place(list, chunk, chunks), place(list, chunk + 1, chunks), met)) return false;
        std::int64_t exchanges = met.exchanges, crossings = met.crossings;
        for (int chunk = 0; chunk < chunks; ++chunk) {
            exchanges += met_[axis * chunks + chunk].exchanges;
            crossings += met_[axis * chunks + chunk].crossings;
        }
        return list.worth_it(exchanges, crossings);
    }

    /// Takes in or out all pairs that were met and whose first box is in this part of all boxes. Those taken in overlap
    /// now, those taken out do not, so neither their order nor a second time changes anything.
    void update_part(std::size_t boxes, int part, int parts) {
        const int from = static_cast<int>(boxes * part / parts), to = static_cast<int>(boxes * (part + 1) / parts);
        const auto mine = [&](const Pair& pair) { return from <= pair.a && pair.a < to; };
        for (const Crossings& met : met_) {
            for (const Pair& pair : met.begun)
                if (mine(pair)) pairs_.insert(pair);
            for (const Pair& pair : met.ended)
                if (mine(pair)) pairs_.erase(pair);
        }
    }

    void rebuild(std::span<const Box> boxes) {
        boxes_ = boxes.size();
        absent_.clear();
        for (std::size_t i = 0; i < boxes.size(); ++i)
            if (!present(boxes[i])) absent_.push_back(static_cast<int>(i));
        met_.clear();
#pragma omp parallel for schedule(static) num_threads(2) if (parallel_ && threads_allowed() > 1)
        for (int axis = 0; axis < 2; ++axis) list_[axis].build(boxes);
        pairs_.assign(boxes.size(), strip_sweep(boxes, list_[0].tags(), list_[1].tags()));
    }

    const bool parallel_;
    std::array<EndOrder, 2> list_{EndOrder(EndOrder::Axis::x), EndOrder(EndOrder::Axis::y)};
    PairSet pairs_;
    std::size_t boxes_ = 0;       // listed or absent
    std::vector<int> absent_;     // when the lists were built
    std::vector<Crossings> met_;  // in this step: chunks of x, chunks of y, joints of x, joints of y
    std::int64_t exchanges_ = 0;
};

}  // namespace

std::unique_ptr<PairSearch> make_isu_separated_search() { return std::make_unique<SeparatedIsuSearch>(false); }
std::unique_ptr<PairSearch> make_isu_parallel_search() { return std::make_unique<SeparatedIsuSearch>(true); }

}  // namespace talus
