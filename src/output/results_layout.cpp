#include "output/results_layout.hpp"

#include "core/errors.hpp"
#include "core/version.hpp"
#include "output/contact_table.hpp"
#include "output/energy_table.hpp"
#include "output/results.hpp"
#include "output/vtk_view.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace talus {
namespace {

template <class T>
void write_list(h5::File& file, const std::string& path, const std::vector<T>& values, const h5::Meaning& meaning) {
    file.write<T>(path, values, {static_cast<std::int64_t>(values.size())}, meaning);
}

void write_points(h5::File& file, const std::string& path, const std::vector<Vec2>& points, const std::string& shape) {
    std::vector<double> flat;
    for (const Vec2& p : points) flat.insert(flat.end(), {p.x(), p.y()});
    file.write<double>(path, flat, {static_cast<std::int64_t>(points.size()), 2}, {"m", shape});
}

void write_files(h5::File& file, const RunInfo& info) {
    std::vector<std::string> names, hashes;
    for (const auto& [name, hash] : info.files) names.push_back(name), hashes.push_back(hash_text(hash));
    file.write_texts("/talus/files/name", names, "files");
    file.write_texts("/talus/files/hash", hashes, "files");
}

void write_provenance(h5::File& file, const Model& model, const RunInfo& info) {
    const std::vector<double> origin{model.origin.x(), model.origin.y()};
    file.make_group("/talus");
    file.set("/talus", "schema_version", std::int64_t{results_schema});
    file.set("/talus", "title", info.title);
    file.set("/talus", "source", info.source);
    file.set("/talus", "scenario_file", info.scenario_file);
    file.set("/talus", "scenario_hash", hash_text(info.scenario_hash));
    file.set("/talus", "talus_version", version);
    file.set("/talus", "compiler", compiler);
    file.set("/talus", "start_date", info.start_date);
    file.set("/talus", "origin", origin);
    file.set("/talus", "solver", info.solver);
    file.set("/talus", "search", info.search);
    file.set("/talus", "threads", std::int64_t{info.threads});
    file.set("/talus", "skin", info.skin);
    file.set("/talus", "time_step", info.time_step);
    file.set("/talus", "stable_bound", info.stable_bound);
    file.set("/talus", "stable_estimate", info.stable_estimate);
    file.set("/talus", "status", status_while_running);
    file.set("/talus", "wall_time", 0.0);
    file.set("/talus", "cpu_time", 0.0);
    file.set("/talus", "steps", std::int64_t{0});
    file.set("/talus", "end_time", 0.0);
    file.set("/talus", "energy_gain", 0.0);
    file.write_text("/talus/scenario", info.scenario_text);
    file.write_text("/talus/canonical_json", info.canonical_json);
    file.write_texts("/talus/overrides", info.overrides, "overrides");
    write_files(file, info);
}

void write_blocks(h5::File& file, const Model& model) {
    const std::string blocks = "/talus/blocks/";
    std::vector<std::uint8_t> held;
    for (BlockId b = 0; b < model.blocks.size(); ++b) held.push_back(model.blocks.held(b));
    file.write_texts(blocks + "name", model.blocks.name, "blocks");
    write_points(file, blocks + "start", model.blocks.start, "blocks x 2");
    write_list(file, blocks + "mass", model.blocks.mass, {"kg", "blocks"});
    write_list(file, blocks + "inertia", model.blocks.inertia, {"kg m2", "blocks"});
    write_list(file, blocks + "area", model.blocks.area, {"m2", "blocks"});
    write_list(file, blocks + "material", model.blocks.material, {"1", "blocks"});
    write_list(file, blocks + "region", model.blocks.region, {"1", "blocks"});
    write_list(file, blocks + "held", held, {"1", "blocks"});
    write_list(file, blocks + "first_part", model.blocks.first_part, {"1", "blocks + 1"});
    write_list(file, "/talus/parts/block", model.parts.block, {"1", "parts"});
    write_list(file, "/talus/parts/first_corner", model.parts.first_corner, {"1", "parts + 1"});
    write_points(file, "/talus/corners/arm", model.corners.arm, "corners x 2");
    write_list(file, "/talus/corners/internal", model.corners.internal, {"1", "corners"});
    file.write_texts("/talus/materials/name", model.material_names, "materials");
    file.write_texts("/talus/regions/name", model.region_names, "regions");
}

void write_joints(h5::File& file, const Model& model) {
    std::vector<std::string> name;
    std::vector<double> kn, ks, friction, cohesion, tension;
    for (const Joint& joint : model.joints) {
        name.push_back(joint.name);
        kn.push_back(joint.kn);
        ks.push_back(joint.ks);
        friction.push_back(degrees(std::atan(joint.tan_friction)));
        cohesion.push_back(joint.cohesion);
        tension.push_back(joint.tension);
    }
    file.write_texts("/talus/joints/name", name, "joints");
    write_list(file, "/talus/joints/normal_stiffness", kn, {"Pa/m", "joints"});
    write_list(file, "/talus/joints/shear_stiffness", ks, {"Pa/m", "joints"});
    write_list(file, "/talus/joints/friction_angle_deg", friction, {"deg", "joints"});
    write_list(file, "/talus/joints/cohesion", cohesion, {"Pa", "joints"});
    write_list(file, "/talus/joints/tension", tension, {"Pa", "joints"});
}

void make_tables(h5::File& file, const Model& model) {
    const std::int64_t blocks = model.blocks.size();
    file.make_rows<double>(frames_group + "time", {}, {"s", "frames"});
    file.make_rows<std::int64_t>(frames_group + "step", {}, {"1", "frames"});
    file.make_rows<std::int32_t>(frames_group + "stage", {}, {"1", "frames"});
    file.make_rows<double>(frames_group + "position", {{blocks, 2}, 1, true}, {"m", "frames x blocks x 2"});
    file.make_rows<double>(frames_group + "angle", {{blocks}, 1, true}, {"rad", "frames x blocks"});
    file.make_rows<std::uint8_t>(frames_group + "removed", {{blocks}, 1, true}, {"1", "frames x blocks"});
    for_each_energy({}, [&](const char* name, double) {
        file.make_rows<double>(energies_group + name, {}, {"J", "frames"});
    });
    file.make_group("/talus/histories");
}

void make_contact_tables(h5::File& file, const Model& model) {
    ContactTable empty;
    for_each_column(empty, [&](const char* name, const char* unit, const auto& column) {
        using T = typename std::decay_t<decltype(column)>::value_type;
        file.make_rows<T>(contacts_group + name, {{}, contact_chunk(model)}, {unit, "contact rows of all frames"});
    });
    file.make_rows<std::int64_t>(contacts_group + "first_row", {}, {"1", "frames"});
    file.make_rows<std::int64_t>(contacts_group + "row_count", {}, {"1", "frames"});
}

}  // namespace

void create_talus_groups(h5::File& file, const Model& model, const RunInfo& info) {
    write_provenance(file, model, info);
    write_blocks(file, model);
    write_joints(file, model);
    make_tables(file, model);
    if (info.contacts) make_contact_tables(file, model);
}

std::int64_t truncate_frames(h5::File& file, std::int64_t frames) {
    for (const std::string& group : {frames_group, energies_group})
        for (const std::string& name : file.children(group)) file.truncate(group + name, frames);
    if (!file.exists(contacts_group + "first_row")) return 0;
    file.truncate(contacts_group + "first_row", frames);
    file.truncate(contacts_group + "row_count", frames);
    std::int64_t left = 0;
    if (frames > 0)
        left = file.read<std::int64_t>(contacts_group + "first_row").back() +
               file.read<std::int64_t>(contacts_group + "row_count").back();
    const ContactTable columns;
    for_each_column(columns,
                    [&](const char* name, const char*, const auto&) { file.truncate(contacts_group + name, left); });
    return left;
}

std::int64_t completed_frames(const h5::File& file) {
    std::int64_t frames = vtk_frames(file);
    for (const std::string& group : {frames_group, energies_group})
        for (const std::string& name : file.children(group)) frames = std::min(frames, file.rows(group + name));
    return frames;
}

void check_results_file(const h5::File& file) {
    if (!file.has_attribute("/talus", "schema_version")) throw InputError(file.path() + ": is not a result of Talus");
    const std::int64_t found = file.integer("/talus", "schema_version");
    if (found != results_schema)
        throw InputError(file.path() + ": written in version " + std::to_string(found) +
                         " of the results format, this program reads version " + std::to_string(results_schema));
}

std::string hash_text(std::uint64_t hash) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

std::int64_t contact_chunk(const Model& model) { return std::clamp<std::int64_t>(3 * model.parts.size(), 256, 32768); }

}  // namespace talus
