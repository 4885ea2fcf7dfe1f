// Boxes in groups of eight that lie near each other, laid out for vector registers, and which of them overlap: S. Pall &
// B. Hess, Comput. Phys. Commun. 184 (2013) 2641-2650, with one box against a group at a time, so that sizes may differ.
#pragma once

#include "contact/cell_grid.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace talus {

/// Place p is number p % 8 of group p / 8. A place where nobody is has bounds that are not numbers: it overlaps nothing.
struct BoxGroups {
    static constexpr int width = 8;  // what a register of 512 bits holds

    struct Bounds {
        alignas(64) double xmin[width], ymin[width], xmax[width], ymax[width];  // m
    };
    struct Limits {
        alignas(32) float xmin[width], ymin[width], xmax[width], ymax[width];  // m, as seen from the centre
    };
    struct Row {  // a box and a group of others with which it is compared
        std::uint32_t place, group;
    };

    std::vector<int> box;             // [places] who is there; -1 = nobody
    std::vector<Bounds> bounds;       // [groups] of now
    std::vector<Limits> limits;       // [groups] coarse boxes: rows are complete while no box has left its own
    std::vector<std::uint8_t> own;    // [places] bit k: overlaps place k of the same group, which comes later in it
    std::vector<Row> rows;            // groups with others
    std::vector<std::uint8_t> found;  // [rows] bit k: overlaps place k of the group

    int size() const { return static_cast<int>(bounds.size()); }  // groups
    void resize(int groups);                                      // nobody is at places that are new
    void enclose(int place, const CoarseBox& limits);
    CoarseBox coarse_box(int place) const;
    CoarseBox reach(int group) const;                  // around all of a group
    bool near(int group, const CoarseBox& box) const;  // whether the coarse box of one of a group overlaps it
    void vacate(int place);
    void add_rows(int group, unsigned lanes, int other);
};

/// Takes the bounds of boxes in groups [begin, end) and compares each with those of its own group. Appends the places of
/// those that have left their limits, or of which a bound is not a number, in order.
void refresh_groups(std::span<const Box> boxes, const Vec2& centre, BoxGroups& groups, int begin, int end,
                    std::vector<int>& escaped);

/// Compares rows [begin, end).
void compare_rows(BoxGroups& groups, std::size_t begin, std::size_t end);

/// Rows for all pairs of two groups, given those whose reaches (around the coarse boxes of each) overlap. Of two groups the
/// one has the rows that has fewer boxes near the other.
void list_rows(BoxGroups& groups, std::span<const CoarseBox> reach, std::span<const Pair> near);

}  // namespace talus
