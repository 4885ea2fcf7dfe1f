// Cutting a domain into blocks, exactly. The implementation is the only file that sees CGAL.
#pragma once

#include "core/types.hpp"

#include <string>
#include <vector>

namespace talus {

struct CutLine {  // segment of a joint, crack or trace
    Vec2 from, to;
    int source;  // index of what it belongs to (joint set, crack, trace map); -1 = none; where lines coincide, the lowest
};

struct CutRegion {
    Polygon outline;
    int id;
};

struct CutInput {
    Polygon outline;
    std::vector<Polygon> holes;      // cut and left empty
    std::vector<CutRegion> regions;  // cut along their outlines; blocks inside carry the id of the last one around them
    std::vector<CutLine> lines;
    // Slivers, blocks below one of these limits, are merged with the neighbour of the longest common edge, smallest first,
    // until none is left; the joint that parted them goes on along their other side if nothing else runs there. Zero keeps
    // all but those narrower than the rounding of coordinates, which have no shape in double precision.
    double sliver_area = 0.0;         // m2
    double sliver_width = 0.0;        // m, 2 area / perimeter
    double sliver_area_share = 0.0;   // as a share of the mean area of the blocks before merging; the larger limit counts
    double sliver_width_share = 0.0;  // as a share of the square root of that mean
};

struct CutBlock {
    Polygon outline;             // counter-clockwise, without corners that are straight to rounding
    std::vector<Polygon> holes;  // clockwise; a block around an island
    std::vector<Polygon> parts;  // convex, counter-clockwise; one equal to outline if the block is convex
    double area;                 // m2
    int region;                  // id, -1 = none
};

struct CutSeam {  // where two blocks touch along a source; for finding the joint of a face
    Vec2 from, to;
    int source;
    int left, right;  // blocks on either side, seen along from -> to
};

struct CutReport {                                 // counts for the user
    int dangling = 0;                              // ends of lines that stop inside a block and cut nothing (pruned)
    int merged = 0;                                // slivers merged
    double merged_area = 0.0;                      // m2
    std::vector<Vec2> merged_at;                   // m, where they were
    int dropped = 0;                               // slivers without a neighbour
    double dropped_area = 0.0;                     // m2
    double sliver_area = 0.0, sliver_width = 0.0;  // m2, m; the limits that were used
    int concave = 0;                               // blocks of more than one convex part
    int islands = 0;                               // groups of blocks enclosed by a single one
    double outline_area = 0.0;  // m2, of the outline less the holes, before anything was merged or dropped
    double blocks_area = 0.0;   // m2, sum over the blocks
};

struct CutResult {
    std::vector<CutBlock> blocks;  // numbered along a space-filling curve, so that neighbours are near in memory
    std::vector<CutSeam> seams;    // every piece of a source that separates two blocks
    CutReport report;
};

/// Cuts the outline along all lines at once (exact arithmetic; coordinates are rounded to double once, at the end). What
/// lies outside the outline is left out; outline, holes and regions may be given in either orientation, but must be simple.
CutResult cut(const CutInput& input);

/// Convex parts of a simple polygon with holes; {outline} itself if it is convex. Parts have no corners of their own: they
/// are parted by diagonals, so that two of them share a whole edge with equal coordinates; at most four times as many as
/// the fewest possible (Hertel & Mehlhorn 1983). Necks and tails thinner than 1e-8 of the polygon are no parts: they are
/// joined to a part, which may then bend inwards by as much, or left out.
std::vector<Polygon> convex_parts(const Polygon& outline, const std::vector<Polygon>& holes = {});

}  // namespace talus
