// What contact searches cost, as tables on the screen and in a file.
#pragma once

#include "simulation/search_bench.hpp"

#include <functional>
#include <string>
#include <vector>

namespace talus::cli {

struct SearchTable {
    std::string scene;
    std::size_t boxes, steps;
    std::vector<SearchCost> costs;
};

/// The same without methods that would take hours for so many boxes; says which. largest(name): most boxes of a method.
SearchBench within_reach(SearchBench bench, std::size_t boxes,
                         const std::function<std::size_t(const std::string&)>& largest);

SearchTable time_and_print(const std::string& scene, const Trajectory& trajectory, const SearchBench& bench);

/// CSV, one row per method. Throws OutputError.
void write_search_tables(const std::string& path, const std::vector<SearchTable>& tables);

}  // namespace talus::cli
