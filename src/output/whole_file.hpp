// A file that is there as a whole or not at all.
#pragma once

#include <functional>
#include <ostream>
#include <string>

namespace talus {

/// Writes beside `path` and renames when all is written: what stood there before stays until then, and nothing half-written
/// is left. Throws OutputError with the reason.
void write_whole_file(const std::string& path, const std::function<void(std::ostream&)>& write);

}  // namespace talus
