// CGAL's box_self_intersection_d: hybrid of streamed segment trees and scanning (Zomorodian & Edelsbrunner 2002), anew at
// every step.
#include "peers.hpp"

#include <CGAL/box_intersection_d.h>

#include <cmath>

namespace talus::peers {
namespace {

struct Item {
    using NT = double;
    using ID = int;
    static int dimension() { return 2; }
    double min_coord(int axis) const { return axis == 0 ? box.xmin : box.ymin; }
    double max_coord(int axis) const { return axis == 0 ? box.xmax : box.ymax; }
    int id() const { return number; }

    Box box;
    int number;
};

class Cgal final : public Peer {
public:
    void update(std::span<const Box> boxes) override {
        items_.clear();
        for (int i = 0; i < static_cast<int>(boxes.size()); ++i) items_.push_back({boxes[i], i});
        found_.clear();
        // Below this number of boxes it scans. The manual says to try: a third of it and three times as much are both
        // slower, at 1e4 boxes as at 1e5, and its default of 10 is two to four times slower.
        const auto cutoff = static_cast<std::ptrdiff_t>(3.0 * std::sqrt(boxes.size()));
        CGAL::box_self_intersection_d(
            items_.begin(), items_.end(), [&](const Item& a, const Item& b) { add(a.number, b.number); }, cutoff,
            CGAL::Box_intersection_d::CLOSED);
    }

private:
    std::vector<Item> items_;
};

}  // namespace

std::unique_ptr<PairSearch> make_cgal() { return std::make_unique<Cgal>(); }

}  // namespace talus::peers
