// One line that moves on a terminal; plain lines now and then in a log file.
#pragma once

#include "core/stopwatch.hpp"
#include "simulation/simulation.hpp"

#include <cstdint>

namespace talus::cli {

class Progress {
public:
    Progress();
    void stage_begun(const Simulation& simulation);
    void operator()(const Simulation& simulation);  // after every step; looks at the clock now and then
    void done();                                    // clears the line

private:
    void show(const Simulation& simulation);
    bool terminal_;
    Stopwatch since_start_, since_line_;
    std::int64_t first_step_ = 0, next_look_ = 0;
    double last_share_ = 0.0;
};

}  // namespace talus::cli
