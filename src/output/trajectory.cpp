#include "output/trajectory.hpp"

#include "core/errors.hpp"
#include "core/memory.hpp"
#include "core/text.hpp"
#include "output/whole_file.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

namespace talus {
namespace {

static_assert(std::endian::native == std::endian::little, "trajectory files are little-endian");
static_assert(sizeof(Box) == 4 * sizeof(double), "boxes are read and written as they lie in memory");

constexpr char magic[] = {'B', 'P', 'T', 'R', 'A', 'J', '0', '1'};
constexpr std::uint64_t header_bytes = sizeof magic + 2 * sizeof(std::uint64_t) + sizeof(double);
constexpr std::uint64_t most_boxes = std::numeric_limits<int>::max() / 2;  // searches count the ends of boxes in int

template <class T>
T number_from(std::istream& file) {
    T value{};
    file.read(reinterpret_cast<char*>(&value), sizeof value);
    return value;
}

template <class T>
void put(std::ostream& file, const T& value) {
    file.write(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string gigabytes(double bytes) { return number(bytes / 1e9) + " GB"; }

std::string what_it_says(const TrajectorySize& size) {
    return std::to_string(size.boxes) + " boxes x " + std::to_string(size.steps) + " steps";
}

InputError fault(const std::string& path, const std::string& message) { return InputError(path + ": " + message); }

/// Leaves the file at its first box.
TrajectorySize read_header(const std::string& path, std::ifstream& file) {
    errno = 0;
    if (std::filesystem::exists(path) && !std::filesystem::is_regular_file(path)) throw fault(path, "is no plain file");
    file.open(path, std::ios::binary);
    if (!file) throw fault(path, std::string("cannot be read: ") + (errno ? std::strerror(errno) : "unknown reason"));
    char first[sizeof magic]{};
    file.read(first, sizeof first);
    if (!std::equal(std::begin(magic), std::end(magic), first))
        throw fault(path, "is not a trajectory: it does not begin with " + std::string(magic, sizeof magic));
    TrajectorySize size;
    size.boxes = number_from<std::uint64_t>(file);
    size.steps = number_from<std::uint64_t>(file);
    size.dt = number_from<double>(file);
    if (!file) throw fault(path, "is cut off within its first " + std::to_string(header_bytes) + " bytes");
    return size;
}

void check_header(const std::string& path, const TrajectorySize& size) {
    if (size.boxes == 0 || size.steps == 0) throw fault(path, "holds nothing: " + what_it_says(size));
    if (!(size.dt >= 0.0 && std::isfinite(size.dt))) throw fault(path, "its time step is " + number(size.dt) + " s");
    if (size.boxes > most_boxes)
        throw fault(path, what_it_says(size) + ": more than " + std::to_string(most_boxes) + " boxes");
    check_trajectory_fits(path + ": " + what_it_says(size), static_cast<double>(size.boxes),
                          static_cast<double>(size.steps));
    // It fits into memory, so the product does not overflow.
    const std::uint64_t expected = header_bytes + size.boxes * size.steps * sizeof(Box),
                        there = std::filesystem::file_size(path);
    if (there == expected) return;
    throw fault(path, (there < expected ? "is cut off: " : "is longer than it says: ") + std::to_string(there) +
                          " bytes are there, " + std::to_string(expected) + " are expected for " + what_it_says(size));
}

/// Why four numbers are no box; empty if they are, or the box is absent.
const char* fault_of(const Box& b) {
    for (const double x : {b.xmin, b.ymin, b.xmax, b.ymax})
        if (!std::isfinite(x)) return "has a number that is not finite";
    if (b.xmin <= b.xmax && b.ymin <= b.ymax) return "";
    const bool absent =
        b.xmin == absent_box.xmin && b.ymin == absent_box.ymin && b.xmax == absent_box.xmax && b.ymax == absent_box.ymax;
    return absent ? "" : "is inverted (an absent box is 1 1 -1 -1)";
}

void check_boxes(const std::string& path, const Trajectory& trajectory) {
    for (std::size_t i = 0; i < trajectory.all.size(); ++i) {
        const Box& b = trajectory.all[i];
        const char* const why = fault_of(b);
        if (!*why) continue;
        throw fault(path, "step " + std::to_string(i / trajectory.boxes) + ", box " + std::to_string(i % trajectory.boxes) +
                              " (" + map_number(b.xmin) + " " + map_number(b.ymin) + " " + map_number(b.xmax) + " " +
                              map_number(b.ymax) + ") " + why);
    }
}

}  // namespace

void check_trajectory_fits(const std::string& subject, double boxes, double steps) {
    const double needed = boxes * steps * sizeof(Box), available = std::min(available_memory(), 0x1p60);
    if (needed <= available) return;
    throw InputError(subject + ": too much for memory, " + gigabytes(needed) + " are needed, " + gigabytes(available) +
                     " available");
}

TrajectorySize read_trajectory_size(const std::string& path) {
    std::ifstream file;
    const TrajectorySize size = read_header(path, file);
    check_header(path, size);
    return size;
}

Trajectory read_trajectory(const std::string& path) {
    std::ifstream file;
    const TrajectorySize size = read_header(path, file);
    check_header(path, size);
    Trajectory trajectory{size.boxes, size.dt, std::vector<Box>(size.boxes * size.steps)};
    file.read(reinterpret_cast<char*>(trajectory.all.data()),
              static_cast<std::streamsize>(trajectory.all.size() * sizeof(Box)));
    if (!file) throw fault(path, "cannot be read to its end");
    check_boxes(path, trajectory);
    return trajectory;
}

void write_trajectory(const std::string& path, const Trajectory& trajectory) {
    write_whole_file(path, [&](std::ostream& file) {
        file.write(magic, sizeof magic);
        put<std::uint64_t>(file, trajectory.boxes);
        put<std::uint64_t>(file, trajectory.steps());
        put(file, trajectory.dt);
        file.write(reinterpret_cast<const char*>(trajectory.all.data()),
                   static_cast<std::streamsize>(trajectory.all.size() * sizeof(Box)));
    });
}

}  // namespace talus
