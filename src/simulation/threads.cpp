#include "simulation/threads.hpp"

#include "core/errors.hpp"

#include <string>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace talus {

void check_threads(int threads) {
    constexpr int most = 1024;
    if (threads < 1 || threads > most)
        throw InputError("threads: " + std::to_string(threads) + " is not between 1 and " + std::to_string(most));
}

void use_threads([[maybe_unused]] int threads) {
#ifdef _OPENMP
    omp_set_num_threads(threads);
#endif
}

#ifdef _OPENMP
ThreadsKept::ThreadsKept() : before_(omp_get_max_threads()) {}
#else
ThreadsKept::ThreadsKept() : before_(1) {}
#endif

ThreadsKept::~ThreadsKept() { use_threads(before_); }

}  // namespace talus
