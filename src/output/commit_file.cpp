#include "output/commit_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>

namespace talus {
namespace {

constexpr std::uint64_t page_size = 4096;  // of the kernels we know; larger pages contain these

/// Copies the bytes that [from, from + count) and [to, to + room) have in common.
void copy_common(std::uint64_t from, std::size_t count, const char* source, std::uint64_t to, std::size_t room,
                 char* target) {
    const std::uint64_t first = std::max(from, to), end = std::min(from + count, to + room);
    if (first < end) std::memcpy(target + (first - to), source + (first - from), end - first);
}

/// One writer at a time. This kind of lock is not the one by which HDF5 keeps readers out.
bool lock(int fd) {
    struct flock whole {};
    whole.l_type = F_WRLCK;
    whole.l_whence = SEEK_SET;
    return ::fcntl(fd, F_OFD_SETLK, &whole) == 0 || (errno != EAGAIN && errno != EACCES);
}

}  // namespace

CommitFile::CommitFile(const std::string& path, Open how) {
    fd_ = ::open(path.c_str(), O_RDWR | O_CLOEXEC | (how == Open::to_replace ? O_CREAT : 0), 0666);
    if (fd_ < 0) {
        fail();
    } else if (!lock(fd_)) {
        problem_ = "another process is writing it";
    } else if (how == Open::to_replace && ::ftruncate(fd_, 0) != 0) {
        fail();
    } else {
        struct stat status;
        if (::fstat(fd_, &status) == 0) size_ = static_cast<std::uint64_t>(status.st_size);
    }
}

CommitFile::~CommitFile() {
    if (fd_ >= 0) ::close(fd_);
}

bool CommitFile::fail() {
    if (problem_.empty()) problem_ = std::strerror(errno);
    return false;
}

bool CommitFile::same_file(const CommitFile& other) const {
    struct stat a, b;
    return ::fstat(fd_, &a) == 0 && ::fstat(other.fd_, &b) == 0 && a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

bool CommitFile::read(std::uint64_t at, std::size_t count, void* bytes) {
    char* const target = static_cast<char*>(bytes);
    for (std::size_t done = 0; done < count;) {
        const ssize_t n = ::pread(fd_, target + done, count - done, static_cast<off_t>(at + done));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return fail();
        if (n == 0) {
            std::memset(target + done, 0, count - done);
            break;
        }
        done += static_cast<std::size_t>(n);
    }
    for (const Change& change : changes_)
        copy_common(change.at, change.bytes.size(), change.bytes.data(), at, count, target);
    return true;
}

bool CommitFile::write(std::uint64_t at, std::size_t count, const void* bytes, int order) {
    if (abandoned_) return true;
    const char* const source = static_cast<const char*>(bytes);
    if (at >= size_) return put(at, count, source);
    bool contained = false;  // changes that overlap agree, so that their order cannot matter for the bytes
    for (Change& change : changes_) {
        copy_common(at, count, source, change.at, change.bytes.size(), change.bytes.data());
        contained = contained || (change.at <= at && at + count <= change.end());
    }
    if (!contained) changes_.push_back({at, order, {source, source + count}});
    return true;
}

bool CommitFile::put(std::uint64_t at, std::size_t count, const char* bytes) {
    for (std::size_t done = 0; done < count;) {
        const ssize_t n = ::pwrite(fd_, bytes + done, count - done, static_cast<off_t>(at + done));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return fail();
        done += static_cast<std::size_t>(n);
    }
    return true;
}

/// Without holes: a change that waits must find its room on the disk.
bool CommitFile::grow(std::uint64_t end) {
    if (end <= size_) return true;
    if (::fallocate(fd_, 0, static_cast<off_t>(size_), static_cast<off_t>(end - size_)) == 0) return true;
    if (errno != EOPNOTSUPP && errno != ENOSYS) return fail();
    return ::ftruncate(fd_, static_cast<off_t>(end)) == 0 || fail();  // this file system cannot promise room
}

bool CommitFile::commit(std::uint64_t end) {
    if (abandoned_ || !grow(end)) return false;
    std::stable_sort(changes_.begin(), changes_.end(), [](const Change& a, const Change& b) { return a.order < b.order; });
    std::set<std::uint64_t, std::greater<>> pages;
    for (const Change& change : changes_) {
        if (change.order < last_order) {
            if (!put(change.at, change.bytes.size(), change.bytes.data())) return false;
        } else {
            for (std::uint64_t page = change.at / page_size; page * page_size < change.end(); ++page) pages.insert(page);
        }
    }
    for (const std::uint64_t page : pages)
        if (!put_page(page)) return false;
    changes_.clear();
    size_ = std::max(size_, end);
    return true;
}

bool CommitFile::put_page(std::uint64_t page) {
    std::uint64_t first = (page + 1) * page_size, end = page * page_size;
    for (const Change& change : changes_) {
        if (change.order < last_order || change.end() <= page * page_size || change.at >= (page + 1) * page_size) continue;
        first = std::min(first, std::max(change.at, page * page_size));
        end = std::max(end, std::min(change.end(), (page + 1) * page_size));
    }
    std::vector<char> bytes(end - first);
    return read(first, bytes.size(), bytes.data()) && put(first, bytes.size(), bytes.data());
}

}  // namespace talus
