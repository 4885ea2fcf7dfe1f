// A result file survives a kill at any moment and a disk that fills up: it opens with every frame completed until then.
#include "core/errors.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/small_run.hpp"

#include <fcntl.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>

using namespace talus;

namespace {

/// Looks on while this process writes: notes what reaches the disk, and lets the disk be full from some write on.
struct Disk {
    struct Write {
        off_t at;
        std::string bytes;
    };
    std::optional<std::vector<Write>> log;  // a growing of the file is a write of nothing at its new end
    std::optional<long> writes_until_full;
} disk;

bool disk_is_full() { return disk.writes_until_full && (*disk.writes_until_full)-- <= 0; }

}  // namespace

// The writing of HDF5 and of talus passes through here, for the names of the program go before those of the C library.
extern "C" ssize_t pwrite(int fd, const void* bytes, size_t count, off_t at) {
    if (disk_is_full()) return errno = ENOSPC, -1;
    if (disk.log) disk.log->push_back({at, {static_cast<const char*>(bytes), count}});
    return ::syscall(SYS_pwrite64, fd, bytes, count, at);
}

extern "C" int fallocate(int fd, int mode, off_t at, off_t count) {
    if (disk_is_full()) return errno = ENOSPC, -1;
    if (disk.log) disk.log->push_back({at + count, {}});
    return static_cast<int>(::syscall(SYS_fallocate, fd, mode, at, count));
}

namespace {

void repeat(const Disk::Write& write, const std::string& path) {
    if (write.bytes.empty()) return std::filesystem::resize_file(path, static_cast<std::uintmax_t>(write.at));
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(write.at).write(write.bytes.data(), static_cast<std::streamsize>(write.bytes.size()));
    REQUIRE(file.flush());
}

/// Writes frames [first, end).
void write_frames(ResultsWriter& writer, const Model& model, int history, int first, int end) {
    for (int k = first; k < end; ++k) test::write_frame(writer, model, history, k);
}

/// Damage, or why the file cannot be read at all.
std::string damage(const std::string& path, const Model& model, int at_least) {
    try {
        return test::damage(path, model, at_least);
    } catch (const std::exception& error) {
        return error.what();
    }
}

constexpr int code_of_output_error = 4, code_of_anything_else = 99;

/// Runs `work(pipe)` in a process of its own, which ends with the code of what it threw.
pid_t in_child(const std::function<void(int)>& work, int& pipe_end) {
    int ends[2];
    REQUIRE(::pipe(ends) == 0);
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        int code = 0;
        try {
            work(ends[1]);
        } catch (const OutputError&) {
            code = code_of_output_error;
        } catch (...) {
            code = code_of_anything_else;
        }
        ::_exit(code);
    }
    ::close(ends[1]);
    pipe_end = ends[0];
    return child;
}

/// Number of frames that were reported through the pipe.
int count_frames(int pipe_end) {
    int frames = 0;
    for (char c; ::read(pipe_end, &c, 1) == 1;) ++frames;
    ::close(pipe_end);
    return frames;
}

void write_and_report(const std::string& path, const Model& model, int frames, int pipe) {
    ResultsWriter writer(path, model, test::run_info());
    const int toe = test::add_toe(writer);
    for (int k = 0; k < frames; ++k) {
        test::write_frame(writer, model, toe, k);
        [[maybe_unused]] const auto sent = ::write(pipe, "f", 1);
    }
}

/// Writes until the disk says no, in a child; the frames it reported must be there.
void fill(const std::string& path, const Model& model, const std::function<void()>& prepare) {
    int pipe_end, status;
    const auto work = [&](int pipe) {
        prepare();
        write_and_report(path, model, 1000000, pipe);
    };
    const pid_t child = in_child(work, pipe_end);
    const int frames = count_frames(pipe_end);
    ::waitpid(child, &status, 0);
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == code_of_output_error);
    CHECK(frames > 5);
    CHECK(damage(path, model, frames) == "");
}

}  // namespace

TEST_CASE("a run killed at any time leaves every frame completed until then") {
    const Model model = test::wall(12, 8);
    const test::Folder folder;
    Random random(1);
    int killed_in_mid_run = 0;
    for (int trial = 0; trial < 200 && killed_in_mid_run < 25; ++trial) {
        const std::string path = folder / ("killed" + std::to_string(trial) + ".h5");
        int pipe_end, status;
        const pid_t child = in_child([&](int pipe) { write_and_report(path, model, 1000000, pipe); }, pipe_end);
        ::usleep(static_cast<useconds_t>(10000 + 200000 * random.uniform()));
        ::kill(child, SIGKILL);
        const int frames = count_frames(pipe_end);
        ::waitpid(child, &status, 0);
        REQUIRE(WIFSIGNALED(status));
        if (frames == 0) continue;
        ++killed_in_mid_run;
        CHECK(damage(path, model, frames) == "");
    }
    CHECK(killed_in_mid_run >= 5);  // on a busy machine some are killed before their first frame
}

TEST_CASE("after each single write on the way from frame to frame the file has every frame completed until then") {
    // HDF5 finds the chunks of a dataset in trees of nodes with 64 entries: the first splits as frame 64 is added, the last
    // of the two as frame 121 is.
    const Model model = test::wall(3, 2);
    const test::Folder folder;
    const std::string path = folder / "run.h5", image = folder / "image.h5";
    ResultsWriter writer(path, model, test::run_info());
    const int toe = test::add_toe(writer);
    int looked_at = 0;
    for (int k = 0; k <= 122; ++k) {
        const bool looking = k == 1 || (k >= 63 && k <= 65) || k >= 120;
        if (looking) std::filesystem::copy_file(path, image, std::filesystem::copy_options::overwrite_existing);
        if (looking) disk.log.emplace();
        test::write_frame(writer, model, toe, k);
        if (!looking) continue;
        const auto writes = *std::exchange(disk.log, std::nullopt);
        for (const Disk::Write& write : writes) {
            repeat(write, image);
            INFO("frame " << k << ", write " << &write - writes.data() << " of " << writes.size() << " at " << write.at);
            REQUIRE(damage(image, model, k) == "");
            ++looked_at;
        }
        REQUIRE(damage(image, model, k + 1) == "");
    }
    CHECK(looked_at > 400);
}

TEST_CASE("when writing begins to fail, it is an output error and the earlier frames stay") {
    const Model model = test::wall(3, 2);
    const test::Folder folder;
    for (long until_full = 0; until_full < 300; until_full += 7) {
        const std::string path = folder / "full.h5";
        ResultsWriter writer(path, model, test::run_info());
        const int toe = test::add_toe(writer);
        write_frames(writer, model, toe, 0, 3);
        int k = 3;
        disk.writes_until_full = until_full;
        CHECK_THROWS_AS(
            [&] {
                for (; k < 20; ++k) test::write_frame(writer, model, toe, k);
            }(),
            OutputError);
        CHECK_THROWS_WITH(writer.flush(), Catch::Contains("No space left on device"));
        disk.writes_until_full.reset();
        INFO("full after " << until_full << " writes, in frame " << k);
        CHECK(damage(path, model, k) == "");
    }
}

TEST_CASE("a limit on the size of files ends a run with an output error and a file that opens") {
    const Model model = test::wall(12, 8);
    const test::Folder folder;
    fill(folder / "limited.h5", model, [] {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{1'500'000, 1'500'000};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    });
}

TEST_CASE("a full disk ends a run with an output error and a file that opens") {
    const test::Folder folder;
    const std::string small = folder / "small";
    std::filesystem::create_directory(small);
    if (::mount("none", small.c_str(), "tmpfs", 0, "size=1500k") != 0) {
        WARN("not allowed to mount a small disk: only the limit on the size of files was tried");
        return;
    }
    fill(small + "/run.h5", test::wall(12, 8), [] {});
    ::umount(small.c_str());
}
