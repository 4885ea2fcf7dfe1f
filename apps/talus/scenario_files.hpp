// The scenarios in a folder.
#pragma once

#include <string>
#include <vector>

namespace talus::cli {

/// All .yaml files in the folder and below it, sorted; `path` itself if it is no folder.
std::vector<std::string> scenario_files(const std::string& path);

}  // namespace talus::cli
