#include "core/version.hpp"

namespace talus {

const char* const version = TALUS_VERSION;
const char* const compiler = TALUS_COMPILER;

}  // namespace talus
