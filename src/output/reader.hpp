// Reads a result file, also one that is still being written or was cut off: only frames that were completed are seen.
#pragma once

#include "output/results.hpp"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace talus {

struct Table {
    std::vector<HistoryColumn> columns;       // [nc] the first one is time
    std::vector<std::vector<double>> values;  // [nc][rows]
    std::size_t rows() const { return values.empty() ? 0 : values[0].size(); }
};

/// Throws InputError if the file is not a result of this version, or is damaged.
class ResultsReader {
public:
    explicit ResultsReader(const std::string& path);

    std::string scenario_text() const;
    std::string canonical_json() const;
    std::vector<std::string> overrides() const;
    std::vector<std::pair<std::string, std::uint64_t>> files() const;     // as in RunInfo
    std::vector<std::pair<std::string, std::string>> attributes() const;  // name and value of /talus, as text, sorted
    /// Name and value of /talus/verdict, as text, sorted; empty if the run ended before anything could be said.
    std::vector<std::pair<std::string, std::string>> verdict() const;
    std::string status() const;  // in progress (or killed) | complete | interrupted | diverged | stopped | refused

    std::int64_t frames() const { return frames_; }
    std::int64_t blocks() const;
    std::vector<double> frame_times() const;  // [frames] s
    Table energies() const;                   // one row per frame
    std::vector<std::string> history_names() const;
    Table history(const std::string& name) const;

private:
    Table table(const std::string& group, const std::vector<std::string>& names, std::int64_t at_most) const;

    h5::File file_;
    std::int64_t frames_ = 0;
};

/// energies.csv and one file per history; the header gives name and unit, numbers are written so that they read back
/// exactly. Returns the paths written. Throws OutputError if the folder cannot be written.
std::vector<std::string> export_csv(const std::string& path, const std::string& folder);

}  // namespace talus
