// How blocks go on. Looks, some 32 in a window of time, are averaged: what rings about its place leaves no trace in the
// mean, and from window to window one sees whether a block stays, comes to rest, or goes on. Docs: method.md, Verdict.
#pragma once

#include "model/model.hpp"
#include "model/state.hpp"
#include "verdict/footing.hpp"

namespace talus {

/// What the simulation knows and a look does not.
struct Circumstances {
    bool loads_are_on = false;      // gravity, loads and driven blocks no longer change
    bool springs = false;           // joints give
    double creep = 0.0;             // m/s, at which nothing moves that can be told from rest
    double smallest_failure = 0.0;  // share of the area of free blocks; less on its way is loose stones
};

/// At the start of a stage, and after displacements have been reset: nothing is known of the stage yet.
void begin_course(const Model& model, const Circumstances& now, State& state);

inline bool look_is_due(const State& state) { return state.course.window > 0.0 && state.time >= state.course.next_look; }

/// True if the window is full: it is to be closed then.
bool take_look(const Model& model, Footing& footing, State& state);

/// Judges every block by the window, and the whole; begins the next one.
void close_window(const Model& model, const Circumstances& now, Footing& footing, State& state);

/// Whether a block that has no mechanism yet seems on its way at the end of the last window.
bool goes_on(const State& state, BlockId b);
/// Whether it has moved visibly and still does, or has gone far: one of those that move, once it is known that some go on.
bool moves(const Model& model, const State& state, BlockId b);
/// Whether so much rock (m2) is a failure, and not some loose stones.
bool is_failure(double area, double smallest);
/// m2, of free blocks that are known to be on their way, or have not rested, or come no further, for `share` of the windows
/// that it takes to be certain.
double restless_area(const Model& model, const State& state, double share);

}  // namespace talus
