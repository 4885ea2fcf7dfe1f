#pragma once

namespace talus {

extern const char* const version;   // of the program, e.g. "0.1.0"
extern const char* const compiler;  // as given by the build, e.g. "GNU 12.2.0 Release"

/// Versions of the two file layouts the program writes.
inline constexpr int results_schema = 1;
inline constexpr int restart_schema = 7;

}  // namespace talus
