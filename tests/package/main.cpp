#include "core/time_table.hpp"
#include "core/version.hpp"

#include <cstdio>

int main() {
    const talus::TimeTable ramp{{0.0, 2.0}, {0.0, 1.0}};
    std::printf("talus %s\n", talus::version);
    return ramp(1.0) == 0.5 ? 0 : 1;
}
