// Sums over all blocks whose bits do not depend on the number of threads.
#pragma once

#include <algorithm>
#include <vector>

namespace talus {

/// sum of value(b) over b in [0, n), in chunks of fixed size.
template <class Value>
double chunk_sum(int n, Value&& value) {
    constexpr int chunk = 256;
    const int chunks = (n + chunk - 1) / chunk;
    std::vector<double> part(chunks, 0.0);
#pragma omp parallel for schedule(static)
    for (int k = 0; k < chunks; ++k)
        for (int b = k * chunk; b < std::min((k + 1) * chunk, n); ++b) part[k] += value(b);
    double sum = 0.0;
    for (const double p : part) sum += p;
    return sum;
}

}  // namespace talus
