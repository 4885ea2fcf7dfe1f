// Where each box was when it was looked at last, how far it may go from there, and how fast it went.
#pragma once

#include "contact/viewpoint.hpp"

#include <vector>

namespace talus {

/// m: the largest change of a bound from one box to another.
double farthest(const Box& a, const Box& b);

/// In single precision: 20 bytes a box are read at every step. Boxes are given as seen from a viewpoint.
struct Regions {
    struct Track {
        float speed;  // m per step: how far a bound went, over the steps it took
        int since;    // step of the reference
    };
    std::vector<float> at;      // [4 n] xmin, ymin, xmax, ymax of the reference, m
    std::vector<float> radius;  // [n] m, how far a bound may be from that of the reference; negative: never inside
    std::vector<Track> track;   // [n]

    /// For n boxes of which no reference is known; of which speeds are only those that were expected, else `speed`.
    void start(int n, int step, double speed);

    Box reference(int i) const {
        const float* bounds = &at[4 * static_cast<std::size_t>(i)];
        return {bounds[0], bounds[1], bounds[2], bounds[3]};
    }

    /// m per step, since the reference was put.
    double speed(int i, const Box& seen, int step) const {
        const int steps = step - track[i].since;
        return steps == 0 ? track[i].speed : farthest(seen, reference(i)) / steps;
    }

    /// Puts the reference where the box is now.
    void move(int i, const Box& seen, int step, const Viewpoint& view);

    /// A box may go so far from its reference, if that is not too far out.
    void close(int i, double most, const Viewpoint& view);

    /// For a box that is not present: it may do what leaves it so.
    void leave_out(int i, const Box& seen, int step, const Viewpoint& view);

    std::vector<float> speeds() const;
    void expect(const std::vector<float>& speeds);
};

}  // namespace talus
