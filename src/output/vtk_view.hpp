// The part of a result file that ParaView reads: VTKHDF, PolyData with time steps, version 2.0. A cell is a convex part of a
// block; cells are never removed, a field marks them. Layout: docs/results-format.md.
#pragma once

#include "model/model.hpp"
#include "model/state.hpp"
#include "output/h5_file.hpp"

namespace talus {

/// The first thing in a file: see commit_vtk_frame.
void create_vtk_view(h5::File& file, const Model& model);

/// Adds a frame that no reader sees until it is committed.
void append_vtk_frame(h5::File& file, const Model& model, const State& state);

/// Makes the appended frame count; the caller flushes. Readers of VTK break when the list of times and the number of steps
/// differ. Both stand in the first page of the file, which changes as a whole and last (see CommitFile).
void commit_vtk_frame(h5::File& file, double time);

std::int64_t vtk_frames(const h5::File& file);

/// Keeps the first `frames` frames.
void truncate_vtk_view(h5::File& file, std::int64_t frames);

}  // namespace talus
