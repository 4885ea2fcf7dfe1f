// Bullet's two broad phases: the dynamic trees (btDbvtBroadphase) and the sorted axes (bt32BitAxisSweep3). Both keep a
// hashed set of pairs, of larger boxes or of rounded ones.
#include "peers.hpp"

#include <BulletCollision/BroadphaseCollision/btAxisSweep3.h>
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>

#include <cstdint>

extern btScalar gDbvtMargin;  // by how much leaves of the trees are made larger; no header of the library has it

namespace talus::peers {
namespace {

class Bullet : public Peer {
public:
    void update(std::span<const Box> boxes) override {
        if (proxy_.empty()) build(boxes);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const FloatBox box = outward(boxes[i]);
            phase_->setAabb(proxy_[i], {box.xmin, box.ymin, 0}, {box.xmax, box.ymax, 0}, nullptr);
        }
        phase_->calculateOverlappingPairs(nullptr);
        collect(boxes);
    }

protected:
    /// Sets phase_ and calls add_proxies.
    virtual void build(std::span<const Box> boxes) = 0;

    void add_proxies(std::span<const Box> boxes, double by) {
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const FloatBox box = outward(boxes[i].grown(by));
            proxy_.push_back(phase_->createProxy({box.xmin, box.ymin, 0}, {box.xmax, box.ymax, 0}, 0,
                                                 reinterpret_cast<void*>(static_cast<std::intptr_t>(i)), 1, 1, nullptr));
        }
    }

    btHashedOverlappingPairCache cache_;
    std::unique_ptr<btBroadphaseInterface> phase_;

private:
    static int number(const btBroadphaseProxy* proxy) {
        return static_cast<int>(reinterpret_cast<std::intptr_t>(proxy->m_clientObject));
    }
    void collect(std::span<const Box> boxes) {
        const btBroadphasePairArray& all = cache_.getOverlappingPairArray();
        found_.resize(static_cast<std::size_t>(all.size()));
        std::size_t n = 0;
        for (int k = 0; k < all.size(); ++k)
            n = keep_if_overlapping(number(all[k].m_pProxy0), number(all[k].m_pProxy1), boxes, n);
        found_.resize(n);
    }
    std::vector<btBroadphaseProxy*> proxy_;
};

class BulletTree final : public Bullet {
public:
    explicit BulletTree(double margin_share) : margin_share_(margin_share) {}

    void update(std::span<const Box> boxes) override {
        if (margin_ == 0.0f) margin_ = static_cast<btScalar>(margin_share_ * mean_side(boxes));
        gDbvtMargin = margin_;  // one for all trees of the process
        Bullet::update(boxes);
    }
    std::string choice() const override { return margin_in_words(margin_); }

private:
    void build(std::span<const Box> boxes) override {
        auto made = std::make_unique<btDbvtBroadphase>(&cache_);
        btDbvtBroadphase& tree = *made;
        phase_ = std::move(made);
        tree.m_deferedcollide = true;  // the pairs of the first step all at once, in the good tree
        add_proxies(boxes, margin_);
        tree.optimize();
        tree.collide(nullptr);
        tree.m_deferedcollide = false;
    }

    double margin_share_;
    btScalar margin_ = 0.0f;  // m
};

class BulletAxes final : public Bullet {
    void build(std::span<const Box> boxes) override {
        Box all = boxes[0];
        for (const Box& box : boxes)
            all = {std::min(all.xmin, box.xmin), std::min(all.ymin, box.ymin), std::max(all.xmax, box.xmax),
                   std::max(all.ymax, box.ymax)};
        // Ends are rounded to a grid over this world; what leaves it becomes slow, not wrong.
        const FloatBox world = outward(all.grown(0.25 * std::max(all.xmax - all.xmin, all.ymax - all.ymin)));
        phase_ =
            std::make_unique<bt32BitAxisSweep3>(btVector3{world.xmin, world.ymin, -1}, btVector3{world.xmax, world.ymax, 1},
                                                static_cast<unsigned>(boxes.size() + 1), &cache_, true);
        add_proxies(boxes, 0.0);
    }
};

}  // namespace

std::unique_ptr<PairSearch> make_bullet_tree() { return std::make_unique<BulletTree>(0.05); }
std::unique_ptr<PairSearch> make_bullet_tree_wide() { return std::make_unique<BulletTree>(0.2); }
std::unique_ptr<PairSearch> make_bullet_axes() { return std::make_unique<BulletAxes>(); }

}  // namespace talus::peers
