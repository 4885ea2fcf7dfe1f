// What a step of the rigid solver leaves for the next one and could make anew.
#pragma once

#include "rigid/bonds.hpp"
#include "rigid/touches.hpp"

#include <optional>

namespace talus::rigid {

struct Scratch {
    std::optional<Bodies> bodies;  // none: blocks have to be joined first
    std::optional<Bonds> bonds;
    Touches touches;
    ImpulseSolver solver;
    Motion start;                        // of the blocks, at the start of the step
    std::vector<Vec2> middle;            // [nb] m, centroids in the middle of it
    std::vector<Velocity> before;        // [nq] at the start of the step
    std::vector<Velocity> kicked;        // [nq] with weight and loads, before contacts act
    std::vector<Velocity> displacement;  // [nq] m, m, rad, that puts right what has drifted; empty = nothing
    std::vector<Force> external;         // [nb] weight and loads
    std::vector<Force> contact;          // [nb] from other bodies
    std::vector<Force> unbalanced;       // [nb] for Bonds::carry
    double fastest = 0.0;                // m/s, of any point, before contacts act
    double left = 0.0;                   // m/s, see Solution
    double skin = 0.0;                   // m, with which boxes were made; grows with the reach of contacts
    bool renewed = true;                 // the contact list is another one: slots have changed
};

}  // namespace talus::rigid
