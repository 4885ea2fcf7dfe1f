#include "simulation/search_bench.hpp"

#include "core/errors.hpp"
#include "core/memory.hpp"
#include "core/stopwatch.hpp"
#include "core/text.hpp"
#include "simulation/threads.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace talus {
namespace {

constexpr std::size_t direct_affordable = 20'000;        // boxes: 0.1 s per step with `direct-simd`
constexpr std::size_t direct_affordable_once = 200'000;  // 10 s

struct Slow {
    const char* method;
    std::size_t boxes;  // from some 0.05 s per step on: minutes for a motion of 200 steps, of which each is repeated
};
constexpr Slow slow[] = {{"direct", 3'000}, {"direct-simd", 20'000}, {"dess", 20'000}, {"dess-fused", 30'000}};

std::string name_of(const SearchCost& cost) {
    return cost.method + (cost.threads > 1 ? ", " + std::to_string(cost.threads) + " threads" : "") +
           (cost.skin > 0.0 ? ", skin " + number(cost.skin) + " m" : "");
}

/// Throws if the reference itself is wrong: then nothing that it judges is worth reading.
std::vector<Pair> reference(std::span<const Box> boxes, Check check, bool first) {
    std::vector<Pair> pairs = pairs_by_sweep(boxes);
    const bool plain = check == Check::direct;
    if (!plain && boxes.size() > (first ? direct_affordable_once : direct_affordable)) return pairs;
    std::vector<Pair> direct;
    make_search(plain ? "direct" : "direct-simd")->find(boxes, direct);
    if (direct != pairs) throw std::logic_error("the sweep that judges searches and `direct` find different pairs");
    return pairs;
}

/// Searches with the same skin side by side, step by step, so that each reference is made once. Everything is measured here
/// but the time of the updates.
class SideBySide {
public:
    SideBySide(const Trajectory& trajectory, const SearchBench& bench) : trajectory_(trajectory), bench_(bench) {}

    void add(SearchCost& cost) {
        const double before = heap_in_use();
        SearchReplay replay(bench_.make, cost.method, cost.threads, cost.skin, trajectory_.boxes);
        cost.bytes = heap_in_use() - before;
        if (cost.skin > 0.0) cost.bytes -= static_cast<double>(sizeof(Box) * trajectory_.boxes);  // ours
        lanes_.emplace_back(cost, std::move(replay)).judged = bench_.check != Check::none && cost.method != "read";
    }

    void step(std::size_t f) {
        bool known = false;
        for (Lane& lane : lanes_) {
            if (!advance(lane, trajectory_.step(f))) continue;
            const Stopwatch clock;
            lane.replay.search().pairs(found_);
            lane.list.push_back(clock.seconds());
            lane.found = found_.size();
            if (!lane.judged) continue;
            if (!known) expected_ = reference(lane.replay.handed(), bench_.check, f == 0);
            known = true;
            lane.right = found_ == expected_;
        }
        for (Lane& lane : lanes_) {
            lane.wrong_steps += !lane.right;
            lane.pairs += static_cast<double>(lane.found);
            if (f == 0) lane.first_exchanges = lane.replay.search().exchanges();
        }
    }

    void finish() {
        const double boxes = static_cast<double>(trajectory_.boxes), steps = static_cast<double>(trajectory_.steps());
        for (Lane& lane : lanes_) {
            SearchCost& cost = lane.cost;
            const PairSearch& search = lane.replay.search();
            cost.exchanges = static_cast<double>(search.exchanges() - lane.first_exchanges) / (boxes * (steps - 1.0));
            cost.pairs = lane.pairs / (boxes * steps);
            cost.bytes /= boxes;
            if (lane.judged) cost.wrong_steps = lane.wrong_steps;
            cost.choice = search.choice();
            // Lists that were written, over all steps: with a skin most steps write none.
            std::nth_element(lane.list.begin(), lane.list.begin() + lane.list.size() / 2, lane.list.end());
            cost.list = 1e9 * lane.list[lane.list.size() / 2] * static_cast<double>(lane.list.size()) / (boxes * steps);
        }
    }

private:
    struct Lane {
        Lane(SearchCost& c, SearchReplay r) : cost(c), replay(std::move(r)) {}
        SearchCost& cost;
        SearchReplay replay;
        bool judged = false, right = true;
        std::int64_t wrong_steps = 0, first_exchanges = 0;
        std::size_t found = 0;  // pairs in the list of now
        double pairs = 0.0;
        std::vector<double> list;  // s
    };

    bool advance(Lane& lane, std::span<const Box> boxes) {
        lane.replay.use_my_threads();
        const double before = heap_in_use();
        const bool searched = lane.replay.advance(boxes);
        lane.cost.bytes += heap_in_use() - before;
        return searched;
    }

    const Trajectory& trajectory_;
    const SearchBench& bench_;
    std::vector<Lane> lanes_;
    std::vector<Pair> found_, expected_;
};

void check_all(const Trajectory& trajectory, const SearchBench& bench, std::vector<SearchCost>& costs, const Say& say) {
    for (const double skin : bench.skins) {
        SideBySide together(trajectory, bench);
        for (SearchCost& cost : costs)
            if (cost.skin == skin) together.add(cost);
        for (std::size_t f = 0; f < trajectory.steps(); ++f) {
            say((bench.check == Check::none ? "listing, step " : "checking, step ") + std::to_string(f + 1) + " of " +
                std::to_string(trajectory.steps()));
            together.step(f);
        }
        together.finish();
    }
}

/// Keeps the fastest time of each step, s. The boxes of a step are put into place before the clock starts: in a run they
/// have just been computed.
void time_once(const Trajectory& trajectory, const MakeSearch& make, const SearchCost& cost, std::vector<double>& fastest) {
    SearchReplay replay(make, cost.method, cost.threads, cost.skin, trajectory.boxes);
    std::vector<Box> boxes(trajectory.boxes);
    for (std::size_t f = 0; f < trajectory.steps(); ++f) {
        const std::span<const Box> now = trajectory.step(f);
        std::copy(now.begin(), now.end(), boxes.begin());
        const Stopwatch clock;
        replay.advance(boxes);
        fastest[f] = std::min(fastest[f], clock.seconds());
    }
}

void summarise(std::vector<double> seconds, std::size_t boxes, SearchCost& cost) {
    for (double& s : seconds) s *= 1e9 / static_cast<double>(boxes);
    cost.first = seconds.front();
    seconds.erase(seconds.begin());
    std::sort(seconds.begin(), seconds.end());
    const auto quantile = [&](double q) {
        return seconds[static_cast<std::size_t>(std::lround(q * static_cast<double>(seconds.size() - 1)))];
    };
    cost.q1 = quantile(0.25), cost.median = quantile(0.5), cost.q3 = quantile(0.75), cost.max = seconds.back();
    cost.mean = std::accumulate(seconds.begin(), seconds.end(), 0.0) / static_cast<double>(seconds.size());
}

}  // namespace

std::vector<std::string> bench_methods() {
    std::vector<std::string> all(search_names().begin(), search_names().end());
    all.push_back("read");
    return all;
}

std::size_t largest_by_default(const std::string& method) {
    for (const Slow& each : slow)
        if (method == each.method) return each.boxes;
    return std::numeric_limits<std::size_t>::max();
}

void check_bench(const SearchBench& bench) {
    for (const std::string& method : bench.methods) bench.make(method);
    for (const int threads : bench.threads) check_threads(threads);
    for (const double skin : bench.skins)
        if (!(skin >= 0.0 && std::isfinite(skin))) throw InputError("skin: " + number(skin) + " m is not 0 or more");
    if (bench.repeat < 1) throw InputError("repeat: " + std::to_string(bench.repeat) + " is not 1 or more");
}

std::vector<SearchCost> time_searches(const Trajectory& trajectory, const SearchBench& bench, const Say& say) {
    check_bench(bench);
    if (trajectory.steps() < 2) throw InputError("a trajectory of one step shows no motion: nothing to time");
    const ThreadsKept kept;
    std::vector<SearchCost> costs;
    for (const double skin : bench.skins)
        for (const int threads : bench.threads)
            for (const std::string& method : bench.methods) {
                costs.emplace_back().method = method;
                costs.back().threads = threads;
                costs.back().skin = skin;
            }
    check_all(trajectory, bench, costs, say);
    std::vector fastest(costs.size(), std::vector(trajectory.steps(), std::numeric_limits<double>::infinity()));
    for (int r = 0; r < bench.repeat; ++r)
        for (std::size_t i = 0; i < costs.size(); ++i) {
            say("repetition " + std::to_string(r + 1) + " of " + std::to_string(bench.repeat) + ": " + name_of(costs[i]));
            time_once(trajectory, bench.make, costs[i], fastest[i]);
        }
    for (std::size_t i = 0; i < costs.size(); ++i) summarise(fastest[i], trajectory.boxes, costs[i]);
    return costs;
}

std::vector<Pair> pairs_by_sweep(std::span<const Box> boxes) {
    std::vector<int> order;  // by xmin
    for (int i = 0; i < std::ssize(boxes); ++i)
        if (boxes[i].xmin <= boxes[i].xmax && boxes[i].ymin <= boxes[i].ymax) order.push_back(i);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return boxes[a].xmin < boxes[b].xmin; });
    std::vector<Box> sorted;
    for (const int i : order) sorted.push_back(boxes[i]);
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < sorted.size(); ++i)
        for (std::size_t j = i + 1; j < sorted.size() && sorted[j].xmin <= sorted[i].xmax; ++j)
            if ((sorted[i].ymin <= sorted[j].ymax) & (sorted[j].ymin <= sorted[i].ymax))
                pairs.push_back({std::min(order[i], order[j]), std::max(order[i], order[j])});
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

}  // namespace talus
