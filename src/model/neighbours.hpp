// Which parts of different blocks share a stretch of edge, and which overlap although they must not.
#pragma once

#include "model/model.hpp"

#include <cstdint>
#include <vector>

namespace talus {

struct Neighbours {
    struct Touch {  // parts a < b of different blocks
        PartId part_a, part_b;
        int edge_a, edge_b;  // corner indices where the edges start
        double s0, s1;       // m, ends of the common stretch along edge_a from its first corner
    };
    struct Overlap {  // the deepest one of two blocks
        BlockId a, b;
        double depth;  // m, shortest way that would part them
        Vec2 at;       // m, middle of what they share
    };
    std::vector<Touch> touches;         // sorted by (part_a, part_b), one per pair
    std::vector<Overlap> overlaps;      // sorted by (a, b)
    std::vector<std::uint8_t> covered;  // [nc] 1 = the edge touches another block somewhere
};

/// Compares all parts at the start. corner[nc]: corners in m as they were given, because their differences are exact where
/// centroid + arm is rounded. tolerance: m, distance below which edges coincide and overlaps are forgiven.
Neighbours find_neighbours(const Model& model, std::span<const Vec2> corner, double tolerance);

}  // namespace talus
