#include "output/results.hpp"

#include "core/errors.hpp"
#include "core/version.hpp"
#include "output/contact_table.hpp"
#include "output/energy_table.hpp"
#include "output/output_path.hpp"
#include "output/results_layout.hpp"
#include "output/static_table.hpp"
#include "output/vtk_view.hpp"

#include <algorithm>
#include <filesystem>
#include <set>

namespace talus {
namespace {

constexpr std::size_t history_rows_in_memory = 4096;  // 33 kB per column; half or twice of it changes nothing noticeable

template <class T>
void append_one(h5::File& file, const std::string& path, T value) {
    file.append<T>(path, std::vector<T>{value});
}

void append_motion(h5::File& file, const State& state) {
    std::vector<double> position;
    position.reserve(2 * state.motion.position.size());
    for (const Vec2& p : state.motion.position) position.insert(position.end(), {p.x(), p.y()});
    append_one(file, frames_group + "time", state.time);
    append_one(file, frames_group + "step", state.step);
    append_one(file, frames_group + "stage", static_cast<std::int32_t>(state.stage));
    file.append<double>(frames_group + "position", position);
    file.append<double>(frames_group + "angle", state.motion.angle);
    file.append<std::uint8_t>(frames_group + "removed", state.removed);
}

void append_energies(h5::File& file, const Energies& energies) {
    for_each_energy(energies, [&](const char* name, double value) { append_one(file, energies_group + name, value); });
}

void check_history_names(const std::string& name, const std::vector<HistoryColumn>& columns) {
    std::set<std::string> seen{"time"};
    const auto bad = [](const std::string& text) { return text.empty() || text.find('/') != std::string::npos; };
    if (bad(name)) throw InputError("history \"" + name + "\": a name must not be empty or contain a slash");
    for (const HistoryColumn& column : columns)
        if (bad(column.name) || !seen.insert(column.name).second)
            throw InputError("history " + name + ": column \"" + column.name +
                             "\" is empty, contains a slash or is twice there");
}

std::vector<std::string> names_of(const std::vector<HistoryColumn>& columns) {
    std::vector<std::string> names;
    for (const HistoryColumn& column : columns) names.push_back(column.name);
    return names;
}

}  // namespace

ResultsWriter::ResultsWriter(const std::string& path, const Model& model, const RunInfo& info)
    : file_(h5::File::create(path)), contacts_(info.contacts) {
    std::error_code nothing_there;
    std::filesystem::remove(restart_path(path), nothing_there);
    create_vtk_view(file_, model);
    create_talus_groups(file_, model, info);
    file_.flush();
}

ResultsWriter ResultsWriter::reopen(const std::string& path, std::uint64_t scenario_hash, std::int64_t frames,
                                    const HistoryRows& rows) {
    check_results_file(h5::File::open(path));
    ResultsWriter writer(h5::File::edit(path));
    h5::File& file = writer.file_;
    if (file.text("/talus", "scenario_hash") != hash_text(scenario_hash))
        throw InputError(path + ": belongs to another scenario than the restart file");
    if (completed_frames(file) < frames)
        throw InputError(path + ": has " + std::to_string(completed_frames(file)) + " frames, the restart file expects " +
                         std::to_string(frames));
    for (const auto& [name, count] : rows)
        if (!file.exists(histories_group + name) || file.rows(histories_group + name + "/time") < count)
            throw InputError(path + ": history " + name + " is shorter than the restart file expects");
    writer.contacts_ = file.exists(contacts_group + "first_row");
    writer.frames_ = frames;
    writer.contact_rows_ = truncate_frames(file, frames);
    truncate_vtk_view(file, frames);
    for (const auto& [name, count] : rows)
        for (const std::string& column : file.children(histories_group + name))
            file.truncate(histories_group + name + "/" + column, count);
    file.set("/talus", "status", status_while_running);
    file.flush();
    return writer;
}

void ResultsWriter::frame(const Model& model, const State& state, const Energies& energies) {
    append_vtk_frame(file_, model, state);
    append_motion(file_, state);
    append_energies(file_, energies);
    if (contacts_) append_contacts(model, state);
    append_histories();
    commit_vtk_frame(file_, state.time);
    file_.flush();
    ++frames_;
}

void ResultsWriter::append_contacts(const Model& model, const State& state) {
    const ContactTable table = contact_table(model, state);
    for_each_column(table, [&](const char* name, const char*, const auto& column) {
        using T = typename std::decay_t<decltype(column)>::value_type;
        file_.append<T>(contacts_group + name, column);
    });
    append_one(file_, contacts_group + "first_row", contact_rows_);
    append_one(file_, contacts_group + "row_count", table.size());
    contact_rows_ += table.size();
}

int ResultsWriter::add_history(const std::string& name, const std::vector<HistoryColumn>& columns) {
    check_history_names(name, columns);
    const std::string group = histories_group + name + "/";
    const bool there = file_.exists(group + "time");
    History history{name, {group + "time"}, {}, there ? file_.rows(group + "time") : 0};
    if (!there) file_.make_rows<double>(group + "time", {}, {"s", "rows"});
    for (const HistoryColumn& column : columns) {
        history.paths.push_back(group + column.name);
        if (!file_.exists(group + column.name)) file_.make_rows<double>(group + column.name, {}, {column.unit, "rows"});
    }
    history.waiting.resize(history.paths.size());
    if (!there) file_.set(histories_group + name, "columns", names_of(columns));
    if (file_.texts(histories_group + name, "columns") != names_of(columns))
        throw InputError("history " + name + ": its columns are not those of " + file_.path());
    histories_.push_back(std::move(history));
    return static_cast<int>(histories_.size()) - 1;
}

void ResultsWriter::append_history(int history, double time, std::span<const double> values) {
    auto& waiting = histories_[history].waiting;
    waiting[0].push_back(time);
    for (std::size_t c = 0; c < values.size(); ++c) waiting[c + 1].push_back(values[c]);
    if (waiting[0].size() >= history_rows_in_memory) append_histories();
}

void ResultsWriter::append_histories() {
    for (History& history : histories_) {
        history.rows += static_cast<std::int64_t>(history.waiting[0].size());
        for (std::size_t c = 0; c < history.paths.size(); ++c) {
            file_.append<double>(history.paths[c], history.waiting[c]);
            history.waiting[c].clear();
        }
    }
}

HistoryRows ResultsWriter::history_rows() const {
    HistoryRows rows;
    for (const History& history : histories_)
        rows.emplace_back(history.name, history.rows + static_cast<std::int64_t>(history.waiting[0].size()));
    return rows;
}

void ResultsWriter::flush() {
    append_histories();
    file_.flush();
}

void ResultsWriter::finish(const RunSummary& summary) {
    append_histories();
    file_.set("/talus", "status", summary.status);
    file_.set("/talus", "wall_time", summary.wall_time);
    file_.set("/talus", "cpu_time", summary.cpu_time);
    file_.set("/talus", "steps", summary.steps);
    file_.set("/talus", "end_time", summary.end_time);
    file_.set("/talus", "energy_gain", summary.energy_gain);
    write_evidence(summary.statics);
    if (summary.verdict) write_verdict(*summary.verdict);
    file_.flush();
}

void ResultsWriter::write_evidence(const Statics& statics) {
    const std::vector<StaticEvidence> stages = static_stages(statics);
    if (stages.empty()) return;
    const auto put = [&]<class T>(const char* name, const std::vector<T>& column, const char* shape) {
        const std::string path = statics_group + name;
        if (!file_.exists(path)) file_.make_rows<T>(path, {}, {"1", shape});
        file_.truncate(path, 0);  // of an earlier end, before the run was resumed
        file_.append<T>(path, column);
    };
    for_each_evidence([&](const char* name, auto member) {
        std::vector<std::decay_t<decltype(stages[0].*member)>> column;
        for (const StaticEvidence& stage : stages) column.push_back(stage.*member);
        put(name, column, "static stages");
    });
    put("newton_ratios", statics.newton_ratios, "steps of Newton's method in all static stages");
}

void ResultsWriter::write_verdict(const StabilityVerdict& v) {
    if (!file_.exists(verdict_group)) file_.make_group(verdict_group);  // else of an earlier end, before the run was resumed
    file_.set(verdict_group, "verdict", std::string(name_of(v.verdict)));
    file_.set(verdict_group, "mechanism", std::string(name_of(v.mechanism)));
    file_.set(verdict_group, "reason", v.reason);
    file_.set(verdict_group, "time", v.time);
    file_.set(verdict_group, "unbalanced_ratio", v.unbalanced_ratio);
    file_.set(verdict_group, "kinetic_energy", v.kinetic_energy);
    file_.set(verdict_group, "kinetic_energy_trend", v.kinetic_energy_trend);
    file_.set(verdict_group, "displacement_trend", v.displacement_trend);
    file_.set(verdict_group, "max_displacement", v.max_displacement);
    file_.set(verdict_group, "moving_blocks", std::int64_t{v.moving_blocks});
    file_.set(verdict_group, "detached_blocks", std::int64_t{v.detached_blocks});
    file_.set(verdict_group, "moving_area", v.moving_area);
    file_.set(verdict_group, "moving_share", v.moving_share);
    const std::string path = verdict_group + "/block_mechanism";
    if (!file_.exists(path)) file_.make_rows<std::uint8_t>(path, {}, {"1", "blocks"});
    file_.truncate(path, 0);
    std::vector<std::uint8_t> codes;
    for (const Mechanism m : v.block_mechanism) codes.push_back(static_cast<std::uint8_t>(m));
    file_.append<std::uint8_t>(path, codes);
}

}  // namespace talus
