// One line that moves on a terminal; plain lines now and then in a log file.
#pragma once

#include "core/stopwatch.hpp"
#include "simulation/simulation.hpp"

#include <cstdint>
#include <string>

namespace talus::cli {

/// One line that is written over and over on a terminal; nothing elsewhere.
class StatusLine {
public:
    StatusLine();
    void show(const std::string& text);  // now and then: looks at the clock
    void clear();

private:
    bool terminal_;
    Stopwatch since_line_;
};

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
