#include "scenario_files.hpp"

#include <algorithm>
#include <filesystem>

namespace talus::cli {

std::vector<std::string> scenario_files(const std::string& path) {
    if (!std::filesystem::is_directory(path)) return {path};
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path))
        if (entry.path().extension() == ".yaml") files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace talus::cli
