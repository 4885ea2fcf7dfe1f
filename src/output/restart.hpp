// The restart file: everything a run needs to go on bit for bit. One description of State serves writing and reading.
#pragma once

#include "model/model.hpp"
#include "model/state.hpp"
#include "output/results.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace talus {

struct RestartInfo : ScenarioInfo {
    std::int64_t frames = 0;  // in the result file at this moment
    HistoryRows history_rows = {};
    int stages_recorded = 0;                       // stages whose end is in the result file
    std::vector<std::vector<double>> memory = {};  // of each probe that has one, in the order of the histories
};

/// Replaces the file in one step: whoever looks finds the old restart or the new one. Contacts that are not alive are left
/// out. Throws OutputError; the old file then stays.
void write_restart(const std::string& path, const RestartInfo& info, const State& state);

/// Throws InputError if the file is not a restart of this version, or is damaged.
RestartInfo read_restart_info(const std::string& path);

/// Every member of State, in every bit. Throws InputError if it is damaged or does not fit the model.
State read_restart(const std::string& path, const Model& model);

}  // namespace talus
