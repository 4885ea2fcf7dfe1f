// Contacts pressed so deep that their forces cannot be trusted: found, told, and in the end refused.
#pragma once

#include "contact/contacts.hpp"
#include "model/model.hpp"
#include "model/placed.hpp"
#include "model/state.hpp"

#include <cstdint>
#include <string>

namespace talus {

struct DeepOverlap {
    const Contact* contact = nullptr;  // none: no contact is pressed
    double depth = 0.0;                // m, shortest way that would part the two, out through the boundary of a block
    double thickness = 0.0;            // m, of the thinner part
    double room = 0.0;                 // m, depth at which the two begin to pass through each other
    Vec2 point = Vec2::Zero();         // m
    double share() const { return contact ? depth / thickness : 0.0; }
};

/// The contact that has used most of its room. Forces push back until the middles of both parts meet, at (t_a + t_b)/2, and
/// then out on the other side; the way that parts them is never longer than that. Three quarters of the thinner part are
/// taken: half of it is common where rock falls on soft joints, all of it may be reached for an instant only. The thickness
/// of a part is its smallest width; where it borders on another part of its block, the least that lies of the block behind
/// one of its outer edges: through an inner edge nothing gets out.
DeepOverlap deepest_overlap(const Model& model, const Placed& placed, const State& state);

/// "0.02 m, 40 % of the thinner part (0.05 m), between block 0 `wall` and block 1 at (x, y)".
std::string describe(const Model& model, const DeepOverlap& overlap);

/// "a normal stiffness of at least 4e11 Pa/m of joint `j` would keep it near 1 %".
std::string remedy(const Model& model, const DeepOverlap& overlap);

/// The same where blocks do not give way at all.
inline constexpr const char* rigid_remedy =
    "rigid blocks do not give way: something presses them together that does not stop, such as a driven block, or the step "
    "is "
    "too long for what changes within it (run.time_step)";

/// Whether the overlaps are to be looked at after this step: so often that two blocks at `speed` (m/s) come closer by no
/// more than a quarter of `thinnest` (m) from look to look, and at least every 128 steps. It depends on the state alone, so
/// that a run that was resumed looks at the same steps.
bool time_to_look(std::int64_t step, double speed, double dt, double thinnest);

/// Whether such a look is one of those that come at least.
bool rare_look(std::int64_t step);

/// What to say if two parts have no room left; empty if all have.
std::string no_room_left(const Model& model, const Placed& placed, const State& state);

/// The same, of the contacts of blocks that move.
std::string no_room_left(const Model& model, const Placed& placed, const State& state, const Awake& awake,
                         const ContactIndex& index);

/// The same of two rigid blocks that lie in each other by `depth` (m), whether their contact carries force or not.
std::string no_room_left(const Model& model, const Placed& placed, const State& state, const Contact& contact, double depth);

}  // namespace talus
