// Where results go, and that earlier ones are never lost.
#pragma once

#include <string>

namespace talus {

/// `path` if there is nothing yet or `force` is set, else the first free of name-2.h5, name-3.h5, ... Throws InputError
/// if nothing can be written there. Leaves no file behind.
std::string choose_output_path(const std::string& path, bool force);

/// slope.h5 -> slope.restart.h5
std::string restart_path(const std::string& results_path);

}  // namespace talus
