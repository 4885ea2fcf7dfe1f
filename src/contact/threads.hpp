// How many threads a search may use.
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

}  // namespace talus
