// Boost.Geometry's R-tree, packed anew at every step and asked once per box: moving boxes one by one costs several times
// more.
#include "peers.hpp"

#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <boost/iterator/function_output_iterator.hpp>

#include <utility>

namespace talus::peers {
namespace {

namespace bg = boost::geometry;
namespace bgi = boost::geometry::index;
using Point = bg::model::point<double, 2, bg::cs::cartesian>;
using Item = std::pair<bg::model::box<Point>, int>;

class BoostRtree final : public Peer {
public:
    void update(std::span<const Box> boxes) override {
        items_.clear();
        for (int i = 0; i < static_cast<int>(boxes.size()); ++i)
            items_.push_back({{{boxes[i].xmin, boxes[i].ymin}, {boxes[i].xmax, boxes[i].ymax}}, i});
        const bgi::rtree<Item, bgi::linear<16>> tree(items_);
        found_.clear();
        for (const Item& item : tree)  // in the order of the tree: neighbours follow each other
            tree.query(bgi::intersects(item.first), boost::make_function_output_iterator([&](const Item& other) {
                           if (item.second < other.second) found_.push_back({item.second, other.second});
                       }));
    }

private:
    std::vector<Item> items_;
};

}  // namespace

std::unique_ptr<PairSearch> make_boost_rtree() { return std::make_unique<BoostRtree>(); }

}  // namespace talus::peers
