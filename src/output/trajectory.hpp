// Boxes of a motion, step after step: recorded once, replayed through every search, here and in other programs.
//
// The file, little-endian: 8 bytes BPTRAJ01, uint64 N boxes, uint64 F steps, float64 dt in s, then float64[F][N][4] xmin
// ymin xmax ymax in m. A box that is absent in a step (its block was deleted) is written as `absent_box`; any other box
// whose lower end lies above its upper one is a fault.
#pragma once

#include "core/types.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace talus {

inline constexpr Box absent_box{1.0, 1.0, -1.0, -1.0};

struct Trajectory {
    std::size_t boxes = 0;  // in every step
    double dt = 0.0;        // s, from step to step
    std::vector<Box> all;   // [steps x boxes] m

    std::size_t steps() const { return boxes == 0 ? 0 : all.size() / boxes; }
    std::span<const Box> step(std::size_t f) const { return std::span(all).subspan(f * boxes, boxes); }
};

/// Throws InputError, before memory is asked for, if the file is none of this kind, is cut off or too long, or holds more
/// than memory does.
struct TrajectorySize {
    std::uint64_t boxes = 0, steps = 0;
    double dt = 0.0;  // s
};
TrajectorySize read_trajectory_size(const std::string& path);

/// Throws InputError as above, or with the first step and box whose numbers are no box.
Trajectory read_trajectory(const std::string& path);

/// Replaces the file, as a whole or not at all. Throws OutputError.
void write_trajectory(const std::string& path, const Trajectory& trajectory);

/// Throws InputError, saying what is needed and what there is, if so many boxes do not fit into memory. `subject` begins the
/// sentence.
void check_trajectory_fits(const std::string& subject, double boxes, double steps);

}  // namespace talus
