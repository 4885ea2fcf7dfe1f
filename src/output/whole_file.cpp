#include "output/whole_file.hpp"

#include "core/errors.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>

namespace talus {

void write_whole_file(const std::string& path, const std::function<void(std::ostream&)>& write) {
    const std::string unfinished = path + ".part";
    errno = 0;
    std::ofstream file(unfinished, std::ios::binary);
    if (file) write(file);
    file.close();
    if (file && std::rename(unfinished.c_str(), path.c_str()) == 0) return;
    const std::string reason = errno ? std::strerror(errno) : "the disk took only a part of it";
    std::remove(unfinished.c_str());
    throw OutputError(path + ": cannot be written: " + reason);
}

}  // namespace talus
