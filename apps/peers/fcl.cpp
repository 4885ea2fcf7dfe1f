// FCL's dynamic tree of boxes, refitted at every step. Its boxes may change their size because we give it a geometry whose
// box is ours; its sweep-and-prune manager cannot take that, it keeps the ends it was built with.
#include "peers.hpp"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>

#include <cstdint>
#include <deque>

namespace talus::peers {
namespace {

class FlatBox final : public fcl::CollisionGeometry<double> {
public:
    explicit FlatBox(const Box& box) { set(box); }
    void computeLocalAABB() override {}  // set by `set`
    void set(const Box& box) {
        aabb_local = {fcl::Vector3d(box.xmin, box.ymin, 0.0), fcl::Vector3d(box.xmax, box.ymax, 0.0)};
    }
};

class Fcl final : public Peer {
public:
    void update(std::span<const Box> boxes) override {
        if (object_.empty()) {
            build(boxes);
        } else {
            for (std::size_t i = 0; i < boxes.size(); ++i) {
                geometry_[i]->set(boxes[i]);
                object_[i].computeAABB();
            }
            manager_.update();
        }
        found_.clear();
        manager_.collide(this, [](Object* a, Object* b, void* self) {  // the boxes of the two overlap: in double, closed
            static_cast<Fcl*>(self)->add(number(a), number(b));
            return false;  // go on
        });
    }

private:
    using Object = fcl::CollisionObjectd;
    static int number(const Object* object) {
        return static_cast<int>(reinterpret_cast<std::intptr_t>(object->getUserData()));
    }

    void build(std::span<const Box> boxes) {
        std::vector<Object*> all;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            geometry_.push_back(std::make_shared<FlatBox>(boxes[i]));
            all.push_back(&object_.emplace_back(geometry_.back()));
            all.back()->setUserData(reinterpret_cast<void*>(static_cast<std::intptr_t>(i)));
        }
        manager_.registerObjects(all);
        manager_.setup();
    }

    std::vector<std::shared_ptr<FlatBox>> geometry_;
    std::deque<Object> object_;
    fcl::DynamicAABBTreeCollisionManagerd manager_;
};

}  // namespace

std::unique_ptr<PairSearch> make_fcl() { return std::make_unique<Fcl>(); }

}  // namespace talus::peers
