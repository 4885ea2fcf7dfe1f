#include "model/hash.hpp"

#include "core/fnv1a.hpp"

#include <bit>

namespace talus {
namespace {

class Hash {
public:
    Hash& operator<<(std::uint64_t bits) {
        for (int byte = 0; byte < 8; ++byte) hash_.add((bits >> (8 * byte)) & 0xffU);  // lowest first
        return *this;
    }
    Hash& operator<<(double x) { return *this << std::bit_cast<std::uint64_t>(x + 0.0); }  // -0.0 + 0.0 is 0.0
    Hash& operator<<(const Vec2& v) { return *this << v.x() << v.y(); }
    Hash& operator<<(int i) { return *this << static_cast<std::uint64_t>(static_cast<std::int64_t>(i)); }
    std::uint64_t value() const { return hash_.value; }

private:
    Fnv1a hash_;
};

void add(Hash& hash, const Contact& contact) {
    hash << contact.part_a << contact.part_b << contact.joint << contact.face << contact.edge_a << contact.edge_b;
    hash << static_cast<int>(contact.touching) << static_cast<int>(contact.slipped) << static_cast<int>(contact.sliding)
         << static_cast<int>(contact.struck);
    hash << contact.length << contact.normal_force << contact.shear_force;
    hash << contact.slip << contact.slip_sum << contact.dilation << contact.moment;
}

}  // namespace

std::uint64_t state_hash(const Model& model, const State& state) {
    Hash hash;
    hash << state.time << static_cast<std::uint64_t>(state.step);
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        hash << static_cast<int>(state.removed[b]);
        if (state.removed[b]) continue;  // what a deleted block does, nobody sees
        hash << state.motion.position[b] << state.motion.angle[b] << state.motion.velocity[b] << state.motion.spin[b];
    }
    for (const Contact& contact : state.contacts.list)
        if (contact.alive) add(hash, contact);
    const Statics& statics = state.statics;
    hash << statics.load_share << statics.damping << statics.shift << statics.now.ratio;
    hash << static_cast<std::uint64_t>(statics.now.iterations);
    for (const Unsettled& stage : state.unsettled) hash << stage.stage << stage.ratio;
    hash << static_cast<std::uint64_t>(state.unsolved.steps) << state.unsolved.way;
    hash << static_cast<int>(state.course.verdict) << state.course.next_look << state.course.kinetic_last;
    for (std::size_t b = 0; b < state.course.speed.size(); ++b)
        hash << state.course.speed[b] << static_cast<int>(state.course.set_out[b])
             << static_cast<int>(state.course.mechanism[b]);
    for (const std::uint8_t fast : state.fast) hash << static_cast<int>(fast);
    for (const std::uint8_t looks : state.calm) hash << static_cast<int>(looks);
    for (const std::uint8_t cell : state.contacts.broken) hash << static_cast<int>(cell);
    return hash.value();
}

}  // namespace talus
