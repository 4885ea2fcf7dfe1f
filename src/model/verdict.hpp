// What is said of a run at its end: whether the blocks stand, and where they go if they do not.
#pragma once

#include "model/state.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace talus {

inline constexpr std::array<const char*, 3> stability_names{"undecided", "stable", "unstable"};  // by Stability
inline constexpr std::array<const char*, 6> mechanism_names{"none", "slide",   "topple", "slide and topple",
                                                            "fall", "rotation"};  // by Mechanism

inline const char* name_of(Stability s) { return stability_names[static_cast<std::size_t>(s)]; }
inline const char* name_of(Mechanism m) { return mechanism_names[static_cast<std::size_t>(m)]; }

struct StabilityVerdict {
    Stability verdict = Stability::undecided;
    Mechanism mechanism = Mechanism::none;  // of the whole moving mass
    std::string reason;                     // one sentence
    double time = 0.0;                      // s, when it was certain, or the end
    double unbalanced_ratio = 0.0;          // 1
    double kinetic_energy = 0.0;            // J
    double kinetic_energy_trend = 0.0;      // 1, mean of the last window over that of the window before
    double displacement_trend = 0.0;        // 1, way of the fastest block in the last window over that in the one before
    double max_displacement = 0.0;          // m, of the centroid of a free block
    int moving_blocks = 0, detached_blocks = 0;
    double moving_area = 0.0;                // m2
    double moving_share = 0.0;               // 1, of the area of all free blocks
    std::vector<Mechanism> block_mechanism;  // [nb] none: still
};

}  // namespace talus
