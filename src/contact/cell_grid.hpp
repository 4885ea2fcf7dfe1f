// Which boxes overlap a given one, while boxes come, go and move: a grid with a level for every size.
//
// A box lies in the one cell of its level that holds its centre; the cells of a level are at least half as large as its
// boxes, so that a question looks at few cells of each level. Cells are hashed (row by row, so that neighbours along x lie
// together): the plane has no bounds and empty cells cost nothing. M. Teschner et al., Optimized spatial hashing for
// collision detection of deformable objects, VMV 2003; levels by size as in D. Krijgsman, V. Ogarko & S. Luding, Comput.
// Part. Mech. 1 (2014) 357-372.
#pragma once

#include "core/types.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace talus {

/// Closed box in single precision, for lists that may hold too much, never too little.
struct CoarseBox {
    float xmin, ymin, xmax, ymax;

    bool overlaps(const CoarseBox& o) const {
        return (xmin <= o.xmax) & (o.xmin <= xmax) & (ymin <= o.ymax) & (o.ymin <= ymax);
    }
};

/// The largest number in single precision that is not above x. Whether that is the nearest one is a coin toss: no branch
/// asks.
inline float rounded_down(double x) {
    const auto f = static_cast<float>(x);
    const auto bits = std::bit_cast<std::uint32_t>(f);
    const auto step = static_cast<std::uint32_t>(f > x);  // towards minus infinity: up in bits if negative, else down
    return std::bit_cast<float>(bits >> 31 ? bits + step : bits - step);
}

/// The box as seen, larger by a margin, m, on all sides.
CoarseBox coarse(const Box& b, double margin);

/// m: how far every bound of a box may change before it leaves its coarse box; negative: it has.
inline double slack(const CoarseBox& outer, const Box& b) {
    return std::min(std::min(b.xmin - outer.xmin, outer.xmax - b.xmax), std::min(b.ymin - outer.ymin, outer.ymax - b.ymax));
}

/// m: margin of the coarse box of a box that moves `speed` m per step, at least `least` of a box. Fast boxes are
/// listed anew every some thirty steps, slow ones hardly ever. Margins differ a little from box to box, so that boxes that
/// move together do not all come at the same step.
double wise_margin(int i, const Box& b, double speed, double typical, double least);

/// Marks boxes with very many neighbours, given all pairs of neighbours: to find one among 512 takes half a microsecond.
std::vector<char> hubs(std::span<const Pair> neighbours, int n);

class CellGrid {
public:
    /// Empties the grid, for n boxes with numbers 0 to n-1 in a plane of the given width, m, most of them of size `typical`,
    /// m.
    void reset(int n, double width, double typical);

    /// A box that is not in the grid may be put in, one that is may be moved or taken out.
    void insert(int i, const CoarseBox& box);
    void move(int i, const CoarseBox& box);
    void remove(int i);
    bool holds(int i) const { return node_[i].level != nowhere; }
    const CoarseBox& box(int i) const { return node_[i].box; }

    /// Calls visit(i) for every box that overlaps `asked` (touching counts), each once, in no useful order; `known` are left
    /// out.
    template <class Visit>
    void overlapping(const CoarseBox& asked, std::span<const int> known, Visit&& visit) {
        if (++question_ == 0) {  // all numbers were used once
            for (Node& node : node_) node.seen = 0;
            question_ = 1;
        }
        for (const int i : known) node_[i].seen = question_;
        // Without a branch for what is only near: whether a neighbour overlaps is a coin toss.
        const std::size_t near = gather(asked);
        std::size_t found = 0;
        for (std::size_t k = 0; k < near; ++k) {
            const int i = near_[k];
            near_[found] = i;
            found += node_[i].box.overlaps(asked);
        }
        for (std::size_t k = 0; k < found; ++k) {
            Node& node = node_[near_[k]];
            if (node.seen == question_) continue;  // known, or met in two cells that share a place
            node.seen = question_;
            visit(near_[k]);
        }
    }

    /// All pairs a < b of boxes in the grid that overlap, sorted: much faster than to ask for each.
    std::vector<Pair> all_overlapping() const;

private:
    struct Node {  // of a box
        CoarseBox box;
        int next;            // in the list of those for whom their place has no room; -1 = the last
        std::uint32_t seen;  // the last question that met it
        int level;
    };
    struct Place {                           // of cells
        std::array<int, 3> box{-1, -1, -1};  // -1 = free
        int more = -1;                       // the first of those for whom there is no room
    };
    struct Level {
        double per_cell;     // 1/m
        std::size_t stride;  // places from one row of cells to the next
        std::size_t first;   // place of the cell (0, 0)
        double largest;      // m, size of its boxes
        int population;
    };
    static constexpr int nowhere = -1, level_count = 64, outsized = level_count;

    static std::int64_t cell(double at, const Level& level) {
        return static_cast<std::int64_t>(std::floor(std::clamp(at * level.per_cell, -1e15, 1e15)));
    }
    std::size_t place(std::int64_t x, std::int64_t y, const Level& level) const {
        // unsigned: far out it may run over
        return (static_cast<std::size_t>(x) + static_cast<std::size_t>(y) * level.stride + level.first) & mask_;
    }
    int level_of(const CoarseBox& box) const;
    std::size_t place_of(const CoarseBox& box, int level) const;
    std::size_t gather(const CoarseBox& asked);
    std::size_t gather(const CoarseBox& asked, int number, std::size_t near);

    double smallest_ = 1.0;  // m, size of the cells of level 0
    std::size_t mask_ = 0;   // places in the table - 1
    std::array<Level, level_count> level_{};
    std::vector<int> levels_;    // that were ever used
    std::vector<int> outsized_;  // boxes too large for any level
    std::vector<Place> place_;
    std::vector<Node> node_;  // by box
    std::vector<int> near_;   // buffer; as long as it ever was
    std::uint32_t question_ = 0;
};

}  // namespace talus
