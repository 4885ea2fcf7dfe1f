// How many threads may be used, and which of them calls.
#pragma once

#ifdef _OPENMP
#include <omp.h>
#endif

namespace talus {

inline int threads_allowed() {
#ifdef _OPENMP
    return omp_get_max_threads();
#else
    return 1;
#endif
}

/// Of the threads of the region that calls, 0 the first.
inline int thread_number() {
#ifdef _OPENMP
    return omp_get_thread_num();
#else
    return 0;
#endif
}

}  // namespace talus
