#pragma once

namespace talus {

/// Version of the program, and of the two file layouts it writes.
inline constexpr const char* version = TALUS_VERSION;
inline constexpr int results_schema = 1;
inline constexpr int restart_schema = 1;

/// "g++ 12.2.0 -O3 ..." as given by the build.
inline constexpr const char* compiler = TALUS_COMPILER;

}  // namespace talus
