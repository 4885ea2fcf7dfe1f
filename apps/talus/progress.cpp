#include "progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace talus::cli {

StatusLine::StatusLine() : terminal_(isatty(STDERR_FILENO) != 0) {}

void StatusLine::show(const std::string& text) {
    if (!terminal_ || since_line_.seconds() < 0.2) return;
    since_line_.lap();
    std::fprintf(stderr, "\r\033[K%s", text.c_str());
    std::fflush(stderr);
}

void StatusLine::clear() {
    if (terminal_) std::fprintf(stderr, "\r\033[K");
}

Progress::Progress() : terminal_(isatty(STDERR_FILENO) != 0) {}

void Progress::stage_begun(const Simulation& simulation) {
    done();
    since_start_ = Stopwatch();
    since_line_ = Stopwatch();
    first_step_ = next_look_ = simulation.state().total_steps;
    last_share_ = 0.0;
}

void Progress::operator()(const Simulation& simulation) {
    if (simulation.state().total_steps < next_look_) return;
    next_look_ = simulation.state().total_steps + 16;
    const Until& until = simulation.stage().until;
    const double share = until.time ? simulation.state().stage_time / *until.time : 0.0;
    const bool due = terminal_ ? since_line_.seconds() > 0.2
                               : since_line_.seconds() > 10.0 && (share > last_share_ + 0.05 || !until.time);
    if (!due) return;
    since_line_.lap();
    last_share_ = share;
    show(simulation);
}

void Progress::show(const Simulation& simulation) {
    const State& state = simulation.state();
    const double elapsed = since_start_.seconds();
    const double rate = static_cast<double>(state.total_steps - first_step_) / std::max(elapsed, 1e-9);
    const Until& until = simulation.stage().until;
    if (simulation.timeless()) {
        std::fprintf(stderr, "%s%s: %lld iterations, %.0f per s, %.0f %% of the load, unbalanced %.1e%s",
                     terminal_ ? "\r\033[K" : "", simulation.stage().name.c_str(),
                     static_cast<long long>(state.statics.now.iterations), rate, 100.0 * state.statics.load_share,
                     state.statics.now.ratio, terminal_ ? "" : "\n");
        std::fflush(stderr);
        return;
    }
    char end[64] = "";
    if (until.time && state.stage_time > 0.0)
        std::snprintf(end, sizeof end, " of %.4g s, ETA %.0f s", *until.time,
                      elapsed * std::max(*until.time / state.stage_time - 1.0, 0.0));
    std::fprintf(stderr, "%s%s: t = %.5g s%s, %.0f steps/s, unbalanced %.1e%s", terminal_ ? "\r\033[K" : "",
                 simulation.stage().name.c_str(), state.stage_time, end, rate, unbalanced_ratio(simulation.model(), state),
                 terminal_ ? "" : "\n");
    std::fflush(stderr);
}

void Progress::done() {
    if (terminal_) std::fprintf(stderr, "\r\033[K");
}

}  // namespace talus::cli
