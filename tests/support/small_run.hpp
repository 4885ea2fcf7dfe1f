// A run without mechanics: frames whose numbers follow from the frame number, so that a reader can tell a damaged one.
#pragma once

#include "output/reader.hpp"
#include "output/restart.hpp"
#include "support/hand_made.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace talus::test {

inline RunInfo run_info() {
    RunInfo info;
    info.title = "A wall";
    info.scenario_file = "wall.yaml";
    info.scenario_text = "title: A wall\n";
    info.canonical_json = "{\"title\":\"A wall\"}";
    info.scenario_hash = 0x0123456789abcdefULL;
    info.files = {{"maps/traces.geojson", 0xfedcba9876543210ULL}};
    info.overrides = {"run.threads=2", "joints.rough.cohesion=1e3"};
    info.solver = "explicit", info.search = "isu";
    info.skin = 0.01, info.time_step = 1e-5, info.stable_bound = 1.25e-5, info.stable_estimate = 2e-5;
    info.start_date = "2024-05-01T12:00:00Z";
    return info;
}

/// Number of frame k that belongs to item i.
inline double number(std::int64_t k, std::int64_t i) {
    return std::sin(1.0 + 7.0 * static_cast<double>(k) + static_cast<double>(i));
}

inline State state_of_frame(const Model& model, std::int64_t k) {
    State state = at_rest(model);
    state.time = 0.5 * static_cast<double>(k), state.step = 100 * k;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        state.motion.position[b] += Vec2(number(k, b), number(k, b + 1));
        state.motion.angle[b] = number(k, b + 2);
        state.motion.velocity[b] = {number(k, b + 3), number(k, b + 4)};
        state.load[b] = {{3.0 * number(k, b), 4.0 * number(k, b)}, 1.0};
    }
    for (int i = 0; i < (5 * k) % 7; ++i) {
        Contact c{};
        c.part_a = 0, c.part_b = 1, c.alive = 1, c.touching = 1;
        c.length = 0.5, c.normal_force = number(k, i);
        state.contacts.list.push_back(c);
    }
    state.contacts.reaction.resize(state.contacts.list.size());
    return state;
}

/// Frame k, preceded by ten rows of the history since the frame before.
inline void write_frame(ResultsWriter& writer, const Model& model, int history, std::int64_t k) {
    for (int i = 0; i < 10; ++i)
        writer.append_history(history, 0.05 * static_cast<double>(10 * k + i),
                              std::vector<double>{number(k, i), number(k, -i)});
    Energies energies;
    energies.kinetic = number(k, 0), energies.gravity = number(k, 1);
    writer.frame(model, state_of_frame(model, k), energies);
}

inline int add_toe(ResultsWriter& writer) { return writer.add_history("toe", {{"velocity_x", "m/s"}, {"stress", "Pa"}}); }

/// What is wrong with the frames of a file, each looked at in every number; empty if all is well.
inline std::string damage(const std::string& path, const Model& model, std::int64_t at_least) {
    const h5::File file = h5::File::open(path);
    const ResultsReader reader(path);
    const std::int64_t frames = reader.frames(), blocks = model.blocks.size();
    if (frames < at_least) return "has " + std::to_string(frames) + " of " + std::to_string(at_least) + " frames";
    if (file.integer("/VTKHDF/Steps", "NSteps") != file.rows("/VTKHDF/Steps/Values")) return "times and steps of VTK differ";
    const auto position = file.read<double>("/talus/frames/position"), angle = file.read<double>("/talus/frames/angle");
    const auto velocity = file.read<float>("/VTKHDF/CellData/velocity"), points = file.read<float>("/VTKHDF/Points");
    const auto force = file.read<float>("/talus/contacts/normal_force");
    const auto first = file.read<std::int64_t>("/talus/contacts/first_row"),
               count = file.read<std::int64_t>("/talus/contacts/row_count");
    const auto kinetic = reader.energies().values[1], times = reader.frame_times();
    const Table toe = reader.history("toe");
    if (toe.rows() < static_cast<std::size_t>(10 * frames)) return "the history is shorter than its frames";
    for (std::int64_t k = 0; k < frames; ++k) {
        const std::string where = " of frame " + std::to_string(k);
        const State expected = state_of_frame(model, k);
        if (times[k] != expected.time || kinetic[k] != number(k, 0)) return "time or energy" + where;
        for (std::int64_t b = 0; b < blocks; ++b) {
            const Vec2& p = expected.motion.position[b];
            const std::int64_t i = k * blocks + b;
            if (position[2 * i] != p.x() || position[2 * i + 1] != p.y() || angle[i] != expected.motion.angle[b])
                return "motion" + where;
            if (velocity[3 * i] != static_cast<float>(expected.motion.velocity[b].x())) return "velocity" + where;
        }
        if (points[3 * k * model.corners.size() + 2] != 0.0f) return "points" + where;
        if (count[k] != (5 * k) % 7) return "number of contacts" + where;
        for (std::int64_t i = 0; i < count[k]; ++i)
            if (force[first[k] + i] != static_cast<float>(number(k, i))) return "contacts" + where;
        for (std::int64_t i = 0; i < 10; ++i)
            if (toe.values[1][10 * k + i] != number(k, i) || toe.values[2][10 * k + i] != number(k, -i))
                return "history" + where;
    }
    return {};
}

}  // namespace talus::test
