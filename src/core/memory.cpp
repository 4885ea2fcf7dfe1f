#include "core/memory.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace talus {

MemoryUse memory_use() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    MemoryUse use;
    use.now = use.peak = 1024.0 * static_cast<double>(usage.ru_maxrss);
    double pages = 0.0, resident = 0.0;
    if (std::ifstream("/proc/self/statm") >> pages >> resident)
        use.now = resident * static_cast<double>(sysconf(_SC_PAGESIZE));
    return use;
}

void release_unused_memory() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

}  // namespace talus
