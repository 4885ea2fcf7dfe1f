// The blocks of a result file as they were at one frame.
#pragma once

#include "model/model.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace talus {

struct Snapshot {
    Vec2 origin = Vec2::Zero();         // m, add to every coordinate to get the user's
    std::int64_t frame = 0;             // from 0
    double time = 0.0;                  // s
    std::vector<std::string> name;      // [nb]
    std::vector<double> area;           // [nb] m2
    Parts parts;                        // block, first_corner; thickness is empty
    Corners corners;                    // arm, normal, offset, length, internal
    std::vector<Vec2> position;         // [nb] m
    std::vector<double> angle;          // [nb] rad
    std::vector<std::uint8_t> removed;  // [nb]
};

/// Of the last frame unless another one is named. Throws InputError if the file is not a result, or has no such frame.
Snapshot read_snapshot(const std::string& path, std::optional<std::int64_t> frame = {});

}  // namespace talus
