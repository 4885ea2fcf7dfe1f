// Contact searches timed and checked on motion that was recorded: every method on the same boxes, in turn.
#pragma once

#include "output/trajectory.hpp"
#include "simulation/advance.hpp"
#include "simulation/search_replay.hpp"

#include <optional>
#include <string>
#include <vector>

namespace talus {

enum class Check {
    none,
    affordable,  // a sweep at every step, itself compared with `direct-simd`: always up to 2e4 boxes, at first up to 2e5
    direct,      // a sweep, compared with `direct` at every step whatever the number of boxes
};

struct SearchBench {
    std::vector<std::string> methods;  // names of `make`: of searches, and `read`: nothing but reading the boxes
    std::vector<int> threads{1};
    std::vector<double> skins{0.0};  // m; > 0: boxes grown by it are searched whenever some box has left its own
    int repeat = 5;                  // of each step the fastest counts
    Check check = Check::affordable;
    MakeSearch make = make_search_or_bound;  // other libraries can stand behind it, to be timed beside ours
};

/// One method with one number of threads and one skin. Times are ns per box and step; the first step, which builds, is
/// apart.
struct SearchCost {
    std::string method;
    int threads = 1;
    double skin = 0.0;                                               // m
    double median = 0.0, q1 = 0.0, q3 = 0.0, mean = 0.0, max = 0.0;  // over the steps
    double first = 0.0;
    double list = 0.0;                        // of writing the pairs out, not part of the times above
    double exchanges = 0.0, pairs = 0.0;      // per box and step
    double bytes = 0.0;                       // per box, held at the end
    std::optional<std::int64_t> wrong_steps;  // whose set of pairs was not the right one
    std::string choice;                       // what a method that chooses has chosen, in words
};

/// Every name of make_search, and `read`.
std::vector<std::string> bench_methods();

/// The most boxes for which a method is tried without being asked for; slow ones would take too long above.
std::size_t largest_by_default(const std::string& method);

/// Throws InputError for a method, number of threads, skin or repetition that cannot be.
void check_bench(const SearchBench& bench);

/// Methods x threads x skins, in that order. Throws InputError if the trajectory has one step only.
std::vector<SearchCost> time_searches(const Trajectory& trajectory, const SearchBench& bench, const Say& say);

/// Every a < b whose boxes overlap, sorted: the reference. Shares nothing with the searches it judges.
std::vector<Pair> pairs_by_sweep(std::span<const Box> boxes);

}  // namespace talus
