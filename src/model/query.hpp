// Blocks by place, where they are now: at a point, in a rectangle, along a line.
#pragma once

#include "core/turn.hpp"
#include "geometry/box_tree.hpp"
#include "model/model.hpp"
#include "model/state.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace talus {

/// Made once for a state, asked often: O(n log n) to make, O(log n + found) to ask. It keeps where the blocks were; the
/// model must stay. Blocks are closed: their edges belong to them, so that two neighbours share a joint. A point off by
/// rounding, up to 1e-9 m, still lies on the edge. Removed blocks are not there. Coordinates in m, in the frame of the
/// model.
class BlockQuery {
public:
    BlockQuery(const Model& model, const State& state)
        : BlockQuery(model.parts, model.corners, state.motion.position, state.motion.angle, state.removed) {}

    /// From the shapes alone, as results hold them: parts[block, first_corner], corners[arm, normal, offset],
    /// position[nb] m, angle[nb] rad, removed[nb].
    BlockQuery(const Parts& parts, const Corners& corners, std::span<const Vec2> position, std::span<const double> angle,
               std::span<const std::uint8_t> removed);

    /// Blocks that hold the point, ascending: several where they meet, none in a gap.
    std::vector<BlockId> at(const Vec2& point) const;

    /// Blocks that share at least a point with the rectangle, ascending; none if its ends are the wrong way round.
    std::vector<BlockId> in(const Box& rectangle) const;

    /// One block met by a line, once however often the line leaves a concave block and comes back. Distances in m from the
    /// beginning of the line.
    struct Hit {
        BlockId block;
        double entry, exit;  // first point inside, last one
        double inside;       // length inside: exit - entry, or less for a concave block
    };

    /// Blocks that share at least a point with the segment, in the order in which it enters them.
    std::vector<Hit> along(const Vec2& from, const Vec2& to) const;

private:
    struct Stretch {  // of a segment inside a part, as shares of its length
        BlockId block;
        double entry, exit;
    };

    Vec2 seen_from(BlockId block, const Vec2& point) const;
    bool holds(PartId part, const Vec2& arm) const;
    bool meets(PartId part, const Vec2& centre, const Vec2& half) const;
    std::optional<Stretch> stretch(PartId part, const Vec2& from, const Vec2& to, double tolerance) const;

    const Parts& parts_;
    const Corners& corners_;
    std::vector<Vec2> position_;  // [nb] m
    std::vector<Turn> turn_;      // [nb]
    std::vector<PartId> part_;    // parts that are there, in the order of the tree
    BoxTree tree_;
};

}  // namespace talus
