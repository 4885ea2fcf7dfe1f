// Trajectory files: what is written is read again, by byte; what is no trajectory is refused in one sentence.
#include "output/trajectory.hpp"

#include "core/errors.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

using namespace talus;

namespace {

bool same(const Box& a, const Box& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

std::string bytes_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

template <class T>
std::string raw(T value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// A file made by hand, of the numbers given.
std::string file_of(std::uint64_t boxes, std::uint64_t steps, double dt, const std::vector<double>& numbers) {
    std::string bytes = "BPTRAJ01" + raw(boxes) + raw(steps) + raw(dt);
    for (const double x : numbers) bytes += raw(x);
    return bytes;
}

/// What the reader says of a file with these bytes; empty if it takes it.
std::string complaint(const std::string& bytes) {
    const test::Folder folder;
    std::ofstream(folder / "a.bpt", std::ios::binary) << bytes;
    try {
        read_trajectory(folder / "a.bpt");
    } catch (const InputError& error) {
        CHECK(error.faults().size() == 1);
        std::string text = error.what();
        const auto at = text.find("a.bpt: ");
        REQUIRE(at != text.npos);
        return text.substr(at + 7);
    }
    return "";
}

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("a trajectory that is written is read again, absent boxes too") {
    const test::Folder folder;
    Trajectory made{2, 0.125, {{0, 1, 2, 3}, {-1, -2, -1, 1e-300}, {0.5, 1, 2.5, 3}, absent_box, absent_box, {4, 5, 6, 7}}};
    write_trajectory(folder / "a.bpt", made);
    const TrajectorySize size = read_trajectory_size(folder / "a.bpt");
    CHECK(size.boxes == 2);
    CHECK(size.steps == 3);
    CHECK(size.dt == 0.125);
    const Trajectory read = read_trajectory(folder / "a.bpt");
    CHECK(read.boxes == 2);
    CHECK(read.steps() == 3);
    CHECK(read.dt == 0.125);
    REQUIRE(read.all.size() == made.all.size());
    for (std::size_t i = 0; i < made.all.size(); ++i) CHECK(same(read.all[i], made.all[i]));
    CHECK(same(read.step(2)[1], Box{4, 5, 6, 7}));
}

TEST_CASE("a trajectory lies in its file as the format says") {
    const test::Folder folder;
    write_trajectory(folder / "a.bpt", {1, 0.5, {{1, 2, 3, 4}, {5, 6, 7, 8}}});
    CHECK(bytes_of(folder / "a.bpt") == file_of(1, 2, 0.5, {1, 2, 3, 4, 5, 6, 7, 8}));
    CHECK(bytes_of(folder / "a.bpt").substr(8, 8) == std::string("\1\0\0\0\0\0\0\0", 8));
}

TEST_CASE("what is no trajectory is refused") {
    CHECK(complaint("") == "is not a trajectory: it does not begin with BPTRAJ01");
    CHECK(complaint("BPTRAJ02" + file_of(1, 1, 0, {0, 0, 1, 1}).substr(8)) ==
          "is not a trajectory: it does not begin with BPTRAJ01");
    CHECK_THROWS_WITH(read_trajectory("/no/such/file.bpt"),
                      Catch::Contains("/no/such/file.bpt: cannot be read: No such file"));
    CHECK_THROWS_WITH(read_trajectory("/"), Catch::Contains("no plain file"));
}

TEST_CASE("a trajectory that is cut off or too long is refused with the bytes there and expected") {
    const std::string good = file_of(1, 2, 0.5, {1, 2, 3, 4, 5, 6, 7, 8});
    REQUIRE(good.size() == 96);
    CHECK(complaint(good).empty());
    CHECK(complaint(good.substr(0, 95)) == "is cut off: 95 bytes are there, 96 are expected for 1 boxes x 2 steps");
    CHECK(complaint(good.substr(0, 32)) == "is cut off: 32 bytes are there, 96 are expected for 1 boxes x 2 steps");
    CHECK(complaint(good.substr(0, 31)) == "is cut off within its first 32 bytes");
    CHECK(complaint(good.substr(0, 8)) == "is cut off within its first 32 bytes");
    CHECK(complaint(good + "x") == "is longer than it says: 97 bytes are there, 96 are expected for 1 boxes x 2 steps");
}

TEST_CASE("a trajectory of nothing, or with no time step, is refused") {
    CHECK(complaint(file_of(0, 5, 0.5, {})) == "holds nothing: 0 boxes x 5 steps");
    CHECK(complaint(file_of(5, 0, 0.5, {})) == "holds nothing: 5 boxes x 0 steps");
    CHECK(complaint(file_of(1, 1, not_a_number, {0, 0, 1, 1})) == "its time step is nan s");
    CHECK(complaint(file_of(1, 1, -1.0, {0, 0, 1, 1})) == "its time step is -1 s");
    CHECK(complaint(file_of(1, 1, 0.0, {0, 0, 1, 1})).empty());
}

TEST_CASE("a box that is no box is refused with its step and number") {
    const auto with = [](const Box& b) {  // as box 1 of step 2
        return complaint(file_of(
            2, 3, 0.5, {0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, b.xmin, b.ymin, b.xmax, b.ymax}));
    };
    CHECK(with({0, 0, 1, 1}).empty());
    CHECK(with({1, 1, 1, 1}).empty());
    CHECK(with(absent_box).empty());
    CHECK(with({0, not_a_number, 1, 1}) == "step 2, box 1 (0 nan 1 1) has a number that is not finite");
    CHECK(with({0, 0, infinite, 1}) == "step 2, box 1 (0 0 inf 1) has a number that is not finite");
    CHECK(with({0, 2, 1, 1}) == "step 2, box 1 (0 2 1 1) is inverted (an absent box is 1 1 -1 -1)");
    CHECK(with({1.5, 0, 1, 1}) == "step 2, box 1 (1.5 0 1 1) is inverted (an absent box is 1 1 -1 -1)");
    CHECK(with({2, 2, -2, -2}) == "step 2, box 1 (2 2 -2 -2) is inverted (an absent box is 1 1 -1 -1)");
}

TEST_CASE("a trajectory too big for memory is refused before memory is asked for") {
    CHECK_THAT(complaint(file_of(1'000'000'000, 1'000'000, 0.5, {})),
               Catch::Contains("1000000000 boxes x 1000000 steps: too much for memory, 3.2e+07 GB are needed"));
    constexpr auto most = std::numeric_limits<std::uint64_t>::max();  // sizes whose product overflows
    CHECK_THAT(complaint(file_of(1u << 29, most, 0.5, {})), Catch::Contains("too much for memory"));
    CHECK_THAT(complaint(file_of(1u << 29, std::uint64_t{1} << 35, 0.5, {})), Catch::Contains("too much for memory"));
    CHECK_THAT(complaint(file_of(most, 1, 0.5, {})), Catch::Contains("more than 1073741823 boxes"));
}

TEST_CASE("a trajectory that cannot be written leaves nothing behind, and the one before stays") {
    const test::Folder folder;
    const Trajectory made{1, 0.5, {{1, 2, 3, 4}}};
    CHECK_THROWS_AS(write_trajectory(folder / "no/a.bpt", made), OutputError);
    std::filesystem::create_directory(folder / "a.bpt");  // cannot be replaced by a file
    CHECK_THROWS_AS(write_trajectory(folder / "a.bpt", made), OutputError);
    CHECK(std::distance(std::filesystem::directory_iterator(folder / "."), {}) == 1);
    write_trajectory(folder / "b.bpt", made);
    write_trajectory(folder / "b.bpt", {1, 0.5, {{1, 2, 3, 4}, {1, 2, 3, 4}}});
    CHECK(read_trajectory(folder / "b.bpt").steps() == 2);
    CHECK(std::distance(std::filesystem::directory_iterator(folder / "."), {}) == 2);
}
