// The rock after the cut: a map of faces whose topology is exact and whose corners are rounded. Slivers are merged and
// blocks are read off it without any exact number.
#pragma once

#include "geometry/cut.hpp"

#include <vector>

namespace talus {

struct PlanarMap {
    struct Half {    // one direction of an edge; halves 2k and 2k+1 belong together
        int from;    // vertex where it starts
        int next;    // the half that follows around the face on its left; -1 outside
        int face;    // on its left; -1 = outside the rock
        int source;  // of the line it lies on, -1 = none; the same for both directions
    };
    std::vector<Vec2> point;  // [nv] m
    std::vector<Half> half;   // [2 ne] edges that bound or lie in a face
    std::vector<int> region;  // [nf] id of the last region that contains the face, -1 = none

    const Vec2& start(int h) const { return point[half[h].from]; }
    const Vec2& end(int h) const { return point[half[h ^ 1].from]; }
    double length(int h) const { return (end(h) - start(h)).norm(); }
};

/// Which block each face belongs to: `of[face]` is a face that stands for the whole block, -1 if the face was dropped.
/// Merging follows the rule of CutInput, is counted in `report`, and may hand the source of an edge to another.
std::vector<int> merge_slivers(PlanarMap& map, const CutInput& limits, CutReport& report);

/// Blocks along a Hilbert curve of their centroids, and the seams between them.
CutResult read_blocks(const PlanarMap& map, const std::vector<int>& of, CutReport report);

}  // namespace talus
