#include "output/reader.hpp"

#include "core/errors.hpp"
#include "output/energy_table.hpp"
#include "output/results_layout.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

namespace talus {
namespace {

/// The shortest text that reads back as the same number.
std::string exact(double value) {
    if (std::abs(value) < 1e15 && value == std::trunc(value)) return std::to_string(static_cast<std::int64_t>(value));
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string attribute_text(const h5::File& file, const std::string& group, const std::string& name) {
    if (file.is_text_attribute(group, name)) return file.text(group, name);
    std::string all;
    for (const double value : file.numbers(group, name)) all.append(all.empty() ? "" : " ").append(exact(value));
    return all;
}

std::vector<std::pair<std::string, std::string>> attributes_of(const h5::File& file, const std::string& group) {
    std::vector<std::pair<std::string, std::string>> all;
    for (const std::string& name : file.attributes(group)) all.emplace_back(name, attribute_text(file, group, name));
    return all;
}

void write_csv(const Table& table, const std::string& path) {
    std::ofstream out(path);
    for (std::size_t c = 0; c < table.columns.size(); ++c)
        out << (c ? "," : "") << table.columns[c].name << " [" << table.columns[c].unit << "]";
    out << "\n";
    for (std::size_t r = 0; r < table.rows(); ++r) {
        for (std::size_t c = 0; c < table.columns.size(); ++c) out << (c ? "," : "") << exact(table.values[c][r]);
        out << "\n";
    }
    out.close();
    if (!out) throw OutputError(path + ": cannot be written");
}

}  // namespace

ResultsReader::ResultsReader(const std::string& path) : file_(h5::File::open(path)) {
    check_results_file(file_);
    frames_ = completed_frames(file_);
}

std::string ResultsReader::scenario_text() const { return file_.read_text("/talus/scenario"); }
std::string ResultsReader::canonical_json() const { return file_.read_text("/talus/canonical_json"); }
std::vector<std::string> ResultsReader::overrides() const { return file_.read_texts("/talus/overrides"); }

std::vector<std::pair<std::string, std::uint64_t>> ResultsReader::files() const {
    std::vector<std::pair<std::string, std::uint64_t>> all;
    if (!file_.exists("/talus/files")) return all;
    const auto names = file_.read_texts("/talus/files/name"), hashes = file_.read_texts("/talus/files/hash");
    for (std::size_t i = 0; i < names.size(); ++i) all.emplace_back(names[i], std::stoull(hashes.at(i), nullptr, 16));
    return all;
}
std::string ResultsReader::status() const { return file_.text("/talus", "status"); }
std::int64_t ResultsReader::blocks() const { return file_.rows("/talus/blocks/mass"); }

std::vector<std::pair<std::string, std::string>> ResultsReader::attributes() const { return attributes_of(file_, "/talus"); }

std::vector<std::pair<std::string, std::string>> ResultsReader::verdict() const {
    if (!file_.exists(verdict_group)) return {};
    return attributes_of(file_, verdict_group);
}

std::vector<double> ResultsReader::frame_times() const {
    auto times = file_.read<double>(frames_group + "time");
    times.resize(static_cast<std::size_t>(frames_));
    return times;
}

Table ResultsReader::energies() const {
    std::vector<std::string> names;
    for_each_energy({}, [&](const char* name, double) { names.emplace_back(name); });
    Table energies = table(energies_group, names, frames_);
    energies.columns.insert(energies.columns.begin(), {"time", "s"});
    energies.values.insert(energies.values.begin(), frame_times());
    return energies;
}

std::vector<std::string> ResultsReader::history_names() const { return file_.children("/talus/histories"); }

Table ResultsReader::history(const std::string& name) const {
    if (!file_.exists(histories_group + name)) throw InputError(file_.path() + ": has no history " + name);
    std::vector<std::string> names = file_.texts("/talus/histories/" + name, "columns");
    names.insert(names.begin(), "time");
    return table(histories_group + name + "/", names, std::numeric_limits<std::int64_t>::max());
}

/// Columns can differ in length by what was being written at a kill: the shortest counts.
Table ResultsReader::table(const std::string& group, const std::vector<std::string>& names, std::int64_t at_most) const {
    Table table;
    std::size_t rows = static_cast<std::size_t>(at_most);
    for (const std::string& name : names) {
        table.columns.push_back({name, file_.text(group + name, "unit")});
        table.values.push_back(file_.read<double>(group + name));
        rows = std::min(rows, table.values.back().size());
    }
    for (auto& column : table.values) column.resize(rows);
    return table;
}

std::vector<std::string> export_csv(const std::string& path, const std::string& folder) {
    const ResultsReader results(path);
    std::error_code exists;
    std::filesystem::create_directories(folder, exists);
    const auto target = [&](const std::string& name) { return (std::filesystem::path(folder) / (name + ".csv")).string(); };
    std::vector<std::string> written{target("energies")};
    write_csv(results.energies(), written.back());
    for (const std::string& name : results.history_names()) {
        written.push_back(target(name == "energies" ? "history-energies" : name));
        write_csv(results.history(name), written.back());
    }
    return written;
}

}  // namespace talus
