#include "output/vtk_view.hpp"

#include "core/turn.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace talus {
namespace {

const std::string root = "/VTKHDF/", steps = root + "Steps/", cell_data = root + "CellData/";

struct Field {
    const char *name, *unit;
    std::int64_t components;
};
constexpr Field fields[] = {
    {"displacement", "m", 3}, {"velocity", "m/s", 3}, {"rotation", "rad", 1}, {"unbalanced_force", "N", 1}};

template <class T>
void write_column(h5::File& file, const std::string& path, const std::vector<T>& values, const std::string& shape) {
    file.write<T>(path, values, {static_cast<std::int64_t>(values.size())}, {"1", shape});
}

template <class T>
void append_one(h5::File& file, const std::string& path, T value) {
    file.append<T>(path, std::vector<T>{value});
}

/// VTK asks for all four kinds of cells; only polygons have any.
void write_topology(h5::File& file, const Model& model) {
    using Ids = std::vector<std::int64_t>;
    const std::int64_t points = model.corners.size(), cells = model.parts.size();
    for (const std::string kind : {"Vertices", "Lines", "Strips"}) {
        write_column(file, root + kind + "/NumberOfCells", Ids{0}, "one number");
        write_column(file, root + kind + "/NumberOfConnectivityIds", Ids{0}, "one number");
        write_column(file, root + kind + "/Connectivity", Ids{}, "empty");
        write_column(file, root + kind + "/Offsets", Ids{0}, "one number");
    }
    Ids corner(static_cast<std::size_t>(points));
    for (std::size_t i = 0; i < corner.size(); ++i) corner[i] = static_cast<std::int64_t>(i);
    write_column(file, root + "Polygons/NumberOfCells", Ids{cells}, "one number");
    write_column(file, root + "Polygons/NumberOfConnectivityIds", Ids{points}, "one number");
    write_column(file, root + "Polygons/Connectivity", corner, "corners");
    write_column(file, root + "Polygons/Offsets", Ids(model.parts.first_corner.begin(), model.parts.first_corner.end()),
                 "parts + 1");
    write_column(file, root + "NumberOfPoints", Ids{points}, "one number");
}

void write_constant_fields(h5::File& file, const Model& model) {
    std::vector<std::int32_t> material, region;
    std::vector<std::uint8_t> held;
    for (const BlockId b : model.parts.block) {
        material.push_back(model.blocks.material[b]);
        region.push_back(model.blocks.region[b]);
        held.push_back(model.blocks.held(b));
    }
    write_column(file, cell_data + "block_id", std::vector<std::int32_t>(model.parts.block), "parts");
    write_column(file, cell_data + "material", material, "parts");
    write_column(file, cell_data + "region", region, "parts");
    write_column(file, cell_data + "held", held, "parts");
}

void make_growing_datasets(h5::File& file, const Model& model) {
    const std::int64_t points = model.corners.size(), cells = model.parts.size();
    file.make_rows<float>(root + "Points", {{3}, points, true}, {"m", "(frames x corners) x 3"});
    for (const Field& field : fields) {
        const h5::Shape row = field.components > 1 ? h5::Shape{field.components} : h5::Shape{};
        const std::string shape = field.components > 1 ? "(frames x parts) x 3" : "frames x parts";
        file.make_rows<float>(cell_data + field.name, {row, cells, true}, {field.unit, shape});
        file.make_rows<std::int64_t>(steps + "CellDataOffsets/" + field.name, {}, {"1", "frames"});
    }
    file.make_rows<std::uint8_t>(cell_data + "removed", {{}, cells, true}, {"1", "frames x parts"});
    file.make_rows<std::int64_t>(steps + "CellDataOffsets/removed", {}, {"1", "frames"});
    for (const std::string name : {"PartOffsets", "NumberOfParts", "PointOffsets"})
        file.make_rows<std::int64_t>(steps + name, {}, {"1", "frames"});
    for (const std::string name : {"CellOffsets", "ConnectivityIdOffsets"})
        file.make_rows<std::int64_t>(steps + name, {{4}}, {"1", "frames x 4 kinds of cells"});
}

void add3(std::vector<float>& column, const Vec2& v) {
    column.insert(column.end(), {static_cast<float>(v.x()), static_cast<float>(v.y()), 0.0f});
}

std::vector<float> points_now(const Model& model, const State& state) {
    std::vector<float> points;
    points.reserve(3 * static_cast<std::size_t>(model.corners.size()));
    for (PartId p = 0; p < model.parts.size(); ++p) {
        const BlockId b = model.parts.block[p];
        const Turn now = turn(state.motion.angle[b]);
        for (int k = model.parts.first_corner[p]; k < model.parts.first_corner[p + 1]; ++k)
            add3(points, state.motion.position[b] + turned(model.corners.arm[k], now));
    }
    return points;
}

/// Force along the axes that are free to move: the others carry the reaction of a support. Without local damping, which
/// would hide part of it.
double unbalanced_force(const Model& model, const State& state, BlockId b) {
    if (state.removed[b]) return 0.0;
    const Vec2& inv_mass = model.blocks.inv_mass[b];
    Vec2 force = state.load[b].force;
    if (!state.damping.empty()) force -= state.damping[b].force;
    return std::hypot(inv_mass.x() > 0.0 ? force.x() : 0.0, inv_mass.y() > 0.0 ? force.y() : 0.0);
}

void append_fields(h5::File& file, const Model& model, const State& state) {
    std::vector<float> displacement, velocity, rotation, unbalanced;
    std::vector<std::uint8_t> removed;
    for (const BlockId b : model.parts.block) {
        add3(displacement, state.motion.position[b] - state.start_position[b]);
        add3(velocity, state.motion.velocity[b]);
        rotation.push_back(static_cast<float>(state.motion.angle[b] - state.start_angle[b]));
        unbalanced.push_back(static_cast<float>(unbalanced_force(model, state, b)));
        removed.push_back(state.removed[b]);
    }
    file.append<float>(cell_data + "displacement", displacement);
    file.append<float>(cell_data + "velocity", velocity);
    file.append<float>(cell_data + "rotation", rotation);
    file.append<float>(cell_data + "unbalanced_force", unbalanced);
    file.append<std::uint8_t>(cell_data + "removed", removed);
}

}  // namespace

void create_vtk_view(h5::File& file, const Model& model) {
    // The number of steps and the list of times come first in the file, into one page: see commit_vtk_frame.
    file.make_group("/VTKHDF/Steps");
    file.set("/VTKHDF/Steps", "NSteps", std::int64_t{0});
    file.make_rows<double>(steps + "Values", {}, {"s", "frames"});
    file.set("/VTKHDF", "Version", std::vector<std::int64_t>{2, 0});
    file.set("/VTKHDF", "Type", "PolyData");
    write_topology(file, model);
    write_constant_fields(file, model);
    make_growing_datasets(file, model);
}

void append_vtk_frame(h5::File& file, const Model& model, const State& state) {
    const std::int64_t k = vtk_frames(file), points = model.corners.size(), cells = model.parts.size();
    file.append<float>(root + "Points", points_now(model, state));
    append_fields(file, model, state);
    for (const Field& field : fields) append_one(file, steps + "CellDataOffsets/" + field.name, k * cells);
    append_one(file, steps + "CellDataOffsets/removed", k * cells);
    append_one(file, steps + "PartOffsets", std::int64_t{0});
    append_one(file, steps + "NumberOfParts", std::int64_t{1});
    append_one(file, steps + "PointOffsets", k * points);
    for (const std::string name : {"CellOffsets", "ConnectivityIdOffsets"})
        file.append<std::int64_t>(steps + name, std::vector<std::int64_t>(4, 0));
}

void commit_vtk_frame(h5::File& file, double time) {
    append_one(file, steps + "Values", time);
    file.set("/VTKHDF/Steps", "NSteps", file.rows(steps + "Values"));
}

std::int64_t vtk_frames(const h5::File& file) { return file.integer("/VTKHDF/Steps", "NSteps"); }

void truncate_vtk_view(h5::File& file, std::int64_t frames) {
    const std::int64_t points = file.read<std::int64_t>(root + "NumberOfPoints").at(0);
    const std::int64_t cells = file.read<std::int64_t>(root + "Polygons/NumberOfCells").at(0);
    file.truncate(root + "Points", frames * points);
    for (const Field& field : fields) file.truncate(cell_data + field.name, frames * cells);
    file.truncate(cell_data + "removed", frames * cells);
    for (const std::string& name : file.children("/VTKHDF/Steps/CellDataOffsets"))
        file.truncate(steps + "CellDataOffsets/" + name, frames);
    for (const std::string name :
         {"PartOffsets", "NumberOfParts", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets", "Values"})
        file.truncate(steps + name, frames);
    file.set("/VTKHDF/Steps", "NSteps", frames);
}

}  // namespace talus
