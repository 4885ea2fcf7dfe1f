// The methods behind the table of names in search.cpp; others ask for them by name.
#pragma once

#include "contact/search.hpp"

namespace talus {

/// Every pair is looked at: the specification. O(N^2).
std::unique_ptr<PairSearch> make_direct_search();

/// The same, many pairs at a time in vector registers: fastest of all that remember nothing, up to some hundred boxes.
std::unique_ptr<PairSearch> make_direct_simd_search();

/// Double-ended spatial sorting (Perkins & Williams 2001): both ends of every box are ranked along x and y, the ranks
/// between the two ends of a box along x name its candidates, the ranks along y strike out. O(N^1.5) in a plane packing, in
/// time and in memory.
std::unique_ptr<PairSearch> make_dess_search();

/// The same box by box: candidates are struck out as they are found, and never stored. O(N^1.5) in time.
std::unique_ptr<PairSearch> make_dess_fused_search();

/// Incremental sort-and-update (Schinner 1999): the order of the ends is repaired, and when two ends change places the set
/// of pairs is changed at once. O(N + changes).
std::unique_ptr<PairSearch> make_isu_search();

/// The same, but first everything is sorted and then the set of pairs is updated once.
std::unique_ptr<PairSearch> make_isu_separated_search();

/// The same with both parts shared among threads.
std::unique_ptr<PairSearch> make_isu_parallel_search();

/// Hierarchical grid: a table of cells for each power of four of the size, filled anew at each step. O(N).
std::unique_ptr<PairSearch> make_grid_search();

/// Safe regions or Verlet lists, whichever the motion asks for: search_auto.cpp.
std::unique_ptr<PairSearch> make_auto_search();

/// One test per box, and a look at those only whose pairs can have changed: safe_regions.cpp.
std::unique_ptr<PairSearch> make_safe_regions_search();

/// Every box against the groups of eight that it may reach, at every step: verlet_lists.cpp.
std::unique_ptr<PairSearch> make_verlet_search();

}  // namespace talus
