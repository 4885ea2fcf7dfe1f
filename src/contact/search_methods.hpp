// The methods behind the table of names in search.cpp; others ask for them by name.
#pragma once

#include "contact/search.hpp"

namespace talus {

/// Every pair is looked at: the specification, and fastest up to some hundred boxes. O(N^2).
std::unique_ptr<PairSearch> make_direct_search();

/// Double-ended spatial sorting (Perkins & Williams 2001): both ends of every box are ranked along x and y, the ranks
/// between the two ends of a box along x name its candidates, the ranks along y strike out. O(N^1.5) in a plane packing.
std::unique_ptr<PairSearch> make_dess_search();

/// Incremental sort-and-update (Schinner 1999): the order of the ends is repaired, and only pairs whose ends changed places
/// are looked at. O(N + changes).
std::unique_ptr<PairSearch> make_isu_search();

}  // namespace talus
