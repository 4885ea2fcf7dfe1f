// A file whose changes take effect all at once, as far as a killed process and a full disk are concerned. Knows bytes, not
// HDF5.
//
// What lies beyond the end of the last commit is written at once: nothing refers to it yet. Changes before that end wait in
// memory until `commit`, which first gets all the room it needs from the disk, then writes them in the order they were
// given: what is pointed to before what points to it. Changes of the last order are written page by page, downwards, each
// page by one call: the kernel copies a page as a whole, so what changes within the first page changes together and last.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace talus {

class CommitFile {
public:
    enum class Open { to_replace, to_change };
    static constexpr int last_order = 1000;

    /// Check `problem()` afterwards. A file that another process has open in this way is refused.
    CommitFile(const std::string& path, Open how);
    CommitFile(const CommitFile&) = delete;
    CommitFile& operator=(const CommitFile&) = delete;
    ~CommitFile();

    bool read(std::uint64_t at, std::size_t count, void* bytes);  // bytes beyond the end are zero
    bool write(std::uint64_t at, std::size_t count, const void* bytes, int order);
    bool commit(std::uint64_t end);        // `end`: size of the file from now on, if it grows
    void abandon() { abandoned_ = true; }  // from now on writes go nowhere and commits fail

    std::uint64_t size() const { return size_; }
    bool same_file(const CommitFile& other) const;
    const std::string& problem() const { return problem_; }  // reason of the first failure, empty if none

private:
    struct Change {
        std::uint64_t at;
        int order;
        std::vector<char> bytes;
        std::uint64_t end() const { return at + bytes.size(); }
    };
    bool put(std::uint64_t at, std::size_t count, const char* bytes);
    bool grow(std::uint64_t end);
    bool put_page(std::uint64_t page);
    bool fail();

    int fd_ = -1;
    std::uint64_t size_ = 0;  // at the last commit
    bool abandoned_ = false;
    std::vector<Change> changes_;
    std::string problem_;
};

}  // namespace talus
