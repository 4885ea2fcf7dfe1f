// Other libraries behind the seam of our own searches, so that one loop times them all. Each one is tuned as its manual
// says, and each one delivers the exact set: libraries that keep larger boxes, or boxes of single precision, hand on
// candidates, and the boxes themselves decide. They take a fixed number of boxes, one or more, all of them present.
#pragma once

#include "contact/search.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace talus::peers {

/// Keeps the set of the last step; `update` of a library fills it, in any order.
class Peer : public PairSearch {
public:
    void pairs(std::vector<Pair>& pairs) const override {
        pairs = found_;
        std::sort(pairs.begin(), pairs.end());
    }

protected:
    void add(int a, int b) { found_.push_back(a < b ? Pair{a, b} : Pair{b, a}); }

    /// Writes a candidate to found_[n] and returns n + 1 if its boxes overlap, else n. Without a branch: it would be guessed
    /// wrong too often.
    std::size_t keep_if_overlapping(int a, int b, std::span<const Box> boxes, std::size_t n) {
        found_[n] = a < b ? Pair{a, b} : Pair{b, a};
        const Box &p = boxes[a], &q = boxes[b];
        return n + ((p.xmin <= q.xmax) & (q.xmin <= p.xmax) & (p.ymin <= q.ymax) & (q.ymin <= p.ymax));
    }

    std::vector<Pair> found_;
};

std::unique_ptr<PairSearch> make_boost_rtree();
std::unique_ptr<PairSearch> make_box2d();       // small margin, for slow motion
std::unique_ptr<PairSearch> make_box2d_wide();  // large margin, for fast motion
std::unique_ptr<PairSearch> make_bullet_axes();
std::unique_ptr<PairSearch> make_bullet_tree();
std::unique_ptr<PairSearch> make_bullet_tree_wide();
std::unique_ptr<PairSearch> make_cgal();
std::unique_ptr<PairSearch> make_fcl();

/// Mean of the sides of all boxes, m. Margins, by which libraries make boxes larger so that most steps leave them alone, are
/// shares of it.
inline double mean_side(std::span<const Box> boxes) {
    double sum = 0.0;
    for (const Box& box : boxes) sum += (box.xmax - box.xmin) + (box.ymax - box.ymin);
    return sum / (2.0 * static_cast<double>(boxes.size()));
}
inline std::string margin_in_words(double margin) { return "margin " + number(margin) + " m"; }

/// A box in single precision that contains the given one. Two relative roundings outwards instead of nextafter, so that
/// the compiler can make vectors of it: nextafter would cost more than a good search.
struct FloatBox {
    float xmin, ymin, xmax, ymax;
};
inline FloatBox outward(const Box& box, double scale = 1.0) {
    constexpr float step = 2.0f * std::numeric_limits<float>::epsilon(), least = std::numeric_limits<float>::min();
    const auto below = [](float v) { return v - (std::abs(v) * step + least); };
    const auto above = [](float v) { return v + (std::abs(v) * step + least); };
    return {below(static_cast<float>(box.xmin * scale)), below(static_cast<float>(box.ymin * scale)),
            above(static_cast<float>(box.xmax * scale)), above(static_cast<float>(box.ymax * scale))};
}

}  // namespace talus::peers
