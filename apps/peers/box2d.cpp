// Box2D 2.4: fat boxes in a dynamic tree. As in its world, only a box that leaves its fat box is put back into the tree and
// asked for its neighbours; pairs of fat boxes are kept until then.
#include "peers.hpp"

#include <box2d/b2_broad_phase.h>

#include <cstdint>

namespace talus::peers {
namespace {

class Box2d final : public Peer {
public:
    explicit Box2d(double margin_share) : margin_share_(margin_share) {}

    void update(std::span<const Box> boxes) override {
        if (boxes_.empty())
            build(boxes);
        else
            move(boxes);
        tree_.UpdatePairs(this);
        collect(boxes);
    }
    std::string choice() const override { return margin_in_words(b2_aabbExtension / scale_); }

    // Called by the library for every pair of fat boxes of which one is new, once.
    void AddPair(void* first, void* second) {
        candidates_.push_back({static_cast<int>(reinterpret_cast<std::intptr_t>(first)),
                               static_cast<int>(reinterpret_cast<std::intptr_t>(second))});
    }

private:
    b2AABB box_of(const Box& box) const {
        const FloatBox f = outward(box, scale_);
        b2AABB aabb;
        aabb.lowerBound.Set(f.xmin, f.ymin);
        aabb.upperBound.Set(f.xmax, f.ymax);
        return aabb;
    }

    void build(std::span<const Box> boxes) {
        scale_ = b2_aabbExtension / (margin_share_ * mean_side(boxes));
        moved_.assign(boxes.size(), 0);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            boxes_.push_back(box_of(boxes[i]));
            proxy_.push_back(tree_.CreateProxy(boxes_[i], reinterpret_cast<void*>(static_cast<std::intptr_t>(i))));
        }
    }

    void move(std::span<const Box> boxes) {
        bool any = false;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const b2AABB now = box_of(boxes[i]);
            if (!tree_.GetFatAABB(proxy_[i]).Contains(now)) {
                tree_.MoveProxy(proxy_[i], now, now.GetCenter() - boxes_[i].GetCenter());
                moved_[i] = 1;
                any = true;
            }
            boxes_[i] = now;
        }
        if (!any) return;
        std::erase_if(candidates_, [&](const Pair& p) { return moved_[p.a] || moved_[p.b]; });  // they come again
        std::fill(moved_.begin(), moved_.end(), 0);
    }

    void collect(std::span<const Box> boxes) {
        found_.resize(candidates_.size());
        std::size_t n = 0;
        for (const auto [i, j] : candidates_) n = keep_if_overlapping(i, j, boxes, n);
        found_.resize(n);
    }

    double margin_share_;
    double scale_ = 1.0;  // the margin of the library is a constant, so the scene is scaled to it
    b2BroadPhase tree_;
    std::vector<int> proxy_;
    std::vector<b2AABB> boxes_;
    std::vector<char> moved_;
    std::vector<Pair> candidates_;
};

}  // namespace

std::unique_ptr<PairSearch> make_box2d() { return std::make_unique<Box2d>(0.05); }
std::unique_ptr<PairSearch> make_box2d_wide() { return std::make_unique<Box2d>(0.35); }

}  // namespace talus::peers
