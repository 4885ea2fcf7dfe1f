// A number recorded while a run goes on, and what can be measured on it. What cannot be measured is NaN: a time that was
// not reached, the frequency of something that does not oscillate.
#pragma once

#include <vector>

namespace talus {

struct Signal {
    std::vector<double> time;   // [n] s, increasing: the true times of the steps
    std::vector<double> value;  // [n]
};

/// The part with first <= time <= last.
Signal between(const Signal& signal, double first, double last);

/// Linear between the two nearest samples.
double value_at(const Signal& signal, double time);

/// (v2 - v1) / (t2 - t1) between the recorded samples nearest to the two times.
double mean_rate(const Signal& signal, double first, double last);

/// Hz, from the first to the last maximum, one after each upward crossing of the mean; needs two of them. A maximum is
/// placed by the parabola through three samples, so the error falls with the square of the time step, and with damping it is
/// that of the damped oscillation.
double frequency(const Signal& signal);

/// Mean logarithmic decrement per cycle, from swings (maximum less the minimum after it, each from a parabola through three
/// samples): the level about which it oscillates need not be known. Needs two swings; swings below 1e-4 of the largest count
/// as rest.
double decrement(const Signal& signal);

/// |closed integral of y dx| over the last full cycle of x, counted between upward crossings of its mean. Both are sampled
/// at the same times.
double loop_area(const Signal& x, const Signal& y);

}  // namespace talus
