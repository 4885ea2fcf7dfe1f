// Reproducible random numbers: the generator is fixed (SplitMix64) and so are the samplers, because the distributions of
// the standard library give other numbers on other platforms.
#pragma once

#include <cstdint>

namespace talus {

class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    std::uint64_t bits();                                                       // SplitMix64 (Steele, Lea & Flood 2014)
    double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }  // [0, 1)
    double normal();  // mean 0, deviation 1 (Marsaglia polar method)
private:
    std::uint64_t state_;
};

}  // namespace talus
