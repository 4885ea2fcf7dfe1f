// Loops shared among threads. A region of OpenMP costs half a microsecond even with one thread, as much as all else in some
// of the loops over a few blocks, and an `if` in the pragma does not save it.
#pragma once

namespace talus {

/// f(i) for i in [0, n), in any order; by this thread alone if there are no more than `few`.
template <class Function>
void for_all(int n, int few, const Function& f) {
    if (n <= few) {
        for (int i = 0; i < n; ++i) f(i);
        return;
    }
#pragma omp parallel for schedule(static)
    for (int i = 0; i < n; ++i) f(i);
}

}  // namespace talus
