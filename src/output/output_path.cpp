#include "output/output_path.hpp"

#include "core/errors.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace talus {
namespace fs = std::filesystem;
namespace {

std::string with_suffix(const std::string& path, const std::string& suffix) {
    const fs::path p(path);
    return (p.parent_path() / (p.stem().string() + suffix + p.extension().string())).string();
}

bool taken(const std::string& path) {
    std::error_code ignored;
    return fs::exists(fs::symlink_status(path, ignored));
}

void check_writable(const std::string& path) {
    const bool there = taken(path);
    const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | (there ? 0 : O_CREAT | O_EXCL), 0666);
    if (fd < 0) throw InputError(path + ": cannot be written: " + std::strerror(errno));
    ::close(fd);
    if (!there) ::unlink(path.c_str());
}

}  // namespace

std::string choose_output_path(const std::string& path, bool force) {
    std::string chosen = path;
    if (!force)
        for (int n = 2; taken(chosen) && !fs::is_directory(chosen); ++n) chosen = with_suffix(path, "-" + std::to_string(n));
    check_writable(chosen);
    return chosen;
}

std::string restart_path(const std::string& results_path) { return with_suffix(results_path, ".restart"); }

}  // namespace talus
