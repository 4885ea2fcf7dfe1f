#include "commands.hpp"
#include "summary.hpp"

#include "output/output_path.hpp"
#include "output/reader.hpp"

#include <cstdio>
#include <filesystem>

namespace talus::cli {

int info_command(const std::string& results) {
    const ResultsReader reader(results);
    std::printf("%s: %s\n", results.c_str(), reader.status().c_str());
    for (const auto& [name, value] : reader.attributes()) std::printf("  %-18s %s\n", name.c_str(), value.c_str());
    for (const std::string& change : reader.overrides()) std::printf("  %-18s %s\n", "set", change.c_str());
    for (const auto& [name, hash] : reader.files())
        std::printf("  %-18s %s, content %016llx\n", "file", name.c_str(), static_cast<unsigned long long>(hash));
    const std::vector<double> times = reader.frame_times();
    std::printf("  %-18s %lld", "blocks", static_cast<long long>(reader.blocks()));
    std::printf("\n  %-18s %zu", "frames", times.size());
    if (!times.empty()) std::printf(", t = %s to %s", number(times.front(), "s").c_str(), number(times.back(), "s").c_str());
    std::printf("\n");
    for (const std::string& name : reader.history_names())
        std::printf("  %-18s %s, %zu rows\n", "history", name.c_str(), reader.history(name).rows());
    for (const auto& [name, value] : reader.verdict())
        std::printf("  %-18s %s\n", (name == "verdict" ? name : "verdict/" + name).c_str(), value.c_str());
    const Table energies = reader.energies();
    if (energies.rows() > 0) {
        std::printf("  energies at the end:");
        for (std::size_t i = 1; i < energies.columns.size(); ++i)
            std::printf("%s %s %s", i == 1 ? "" : ",", energies.columns[i].name.c_str(),
                        number(energies.values[i].back(), energies.columns[i].unit.c_str()).c_str());
        std::printf("\n");
    }
    if (std::filesystem::exists(restart_path(results)))
        std::printf("  restart file       %s: talus resume %s\n", restart_path(results).c_str(), results.c_str());
    return ok;
}

int export_command(const std::string& results, const std::string& folder) {
    for (const std::string& path : export_csv(results, folder)) std::printf("%s\n", path.c_str());
    return ok;
}

}  // namespace talus::cli
