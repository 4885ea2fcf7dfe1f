#include "core/memory.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>
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

double available_memory() {
    std::ifstream file("/proc/meminfo");
    for (std::string line; std::getline(file, line);)
        if (line.rfind("MemAvailable:", 0) == 0) return 1024.0 * std::strtod(line.c_str() + sizeof "MemAvailable:", nullptr);
    return std::numeric_limits<double>::infinity();
}

double heap_in_use() {
#ifdef __GLIBC__
    const auto all = mallinfo2();
    return static_cast<double>(all.uordblks) + static_cast<double>(all.hblkhd);
#else
    return 0.0;
#endif
}

void release_unused_memory() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

}  // namespace talus
