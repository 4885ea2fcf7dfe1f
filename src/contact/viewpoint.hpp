// Where boxes are seen from when they are compared in single precision: a centre that goes along with most of them.
#pragma once

#include "core/types.hpp"

#include <array>

namespace talus {

/// Coordinates less the centre. Rounding keeps order (x <= y gives x - c <= y - c), so that boxes that overlap do so as
/// seen.
class Viewpoint {
public:
    /// Centre and sizes of the scene, from the middle of all boxes: what lies far out or is of no size spoils nothing.
    void choose(std::span<const Box> boxes);

    /// Lets the centre go along with what most of the boxes did since the last step, as falling does. A sample tells; where
    /// its members go many ways, the centre stays. While `calm` (hardly a box moves) nothing is to be gained, and nobody is
    /// asked.
    void follow(std::span<const Box> boxes, bool calm);

    Box seen(const Box& b) const {
        return {b.xmin - centre_.x(), b.ymin - centre_.y(), b.xmax - centre_.x(), b.ymax - centre_.y()};
    }
    const Vec2& centre() const { return centre_; }
    double typical() const { return typical_; }   // m, size of a box in the middle
    double width() const { return 0.25 * far_; }  // m, about that of the scene

    /// Not so far out that the guard against rounding would be too small; as seen.
    bool ordinary(const Box& b) const { return b.xmin >= -far_ && b.ymin >= -far_ && b.xmax <= far_ && b.ymax <= far_; }

    /// m: more than all rounding of what is compared with a radius, until the centre has gone too far.
    double guard() const { return guard_; }
    bool gone_too_far() const { return rounding() > guard_; }

    /// Whether a speed, m per step, is one that a box can have.
    bool believable(double speed) const { return speed < far_; }

private:
    static constexpr int sample_size = 31;
    static constexpr int patience = 64;  // steps without common motion until nobody is asked any more

    double rounding() const;

    Vec2 centre_ = Vec2::Zero();  // m
    double typical_ = 1.0, far_ = 1.0, guard_ = 0.0;
    int following_ = 0;                     // steps for which the centre may move
    std::array<Vec2, sample_size> sample_;  // m, middles of some boxes in the last step
};

}  // namespace talus
