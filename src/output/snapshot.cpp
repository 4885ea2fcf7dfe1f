#include "output/snapshot.hpp"

#include "core/errors.hpp"
#include "output/h5_file.hpp"
#include "output/results_layout.hpp"

namespace talus {
namespace {

std::vector<Vec2> points(const std::vector<double>& numbers) {
    std::vector<Vec2> all;
    for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) all.emplace_back(numbers[i], numbers[i + 1]);
    return all;
}

/// Edges follow from the corners.
void read_shapes(const h5::File& file, Snapshot& s) {
    s.parts.block = file.read<std::int32_t>("/talus/parts/block");
    s.parts.first_corner = file.read<std::int32_t>("/talus/parts/first_corner");
    s.corners.arm = points(file.read<double>("/talus/corners/arm"));
    s.corners.internal = file.read<std::uint8_t>("/talus/corners/internal");
    for (PartId p = 0; p < s.parts.size(); ++p) {
        const int first = s.parts.first_corner[p], end = s.parts.first_corner[p + 1];
        for (int k = first; k < end; ++k) {
            const Vec2 edge = s.corners.arm[k + 1 < end ? k + 1 : first] - s.corners.arm[k];
            const Vec2 normal = -perp(edge) / edge.norm();
            s.corners.normal.push_back(normal);
            s.corners.offset.push_back(normal.dot(s.corners.arm[k]));
            s.corners.length.push_back(edge.norm());
        }
    }
}

std::int64_t frame_meant(const h5::File& file, std::optional<std::int64_t> frame) {
    const std::int64_t frames = completed_frames(file);
    if (frames == 0) throw InputError(file.path() + ": holds no frame yet");
    if (!frame) return frames - 1;
    if (*frame >= 0 && *frame < frames) return *frame;
    throw InputError(file.path() + ": there is no frame " + std::to_string(*frame) + ", the last one is " +
                     std::to_string(frames - 1));
}

}  // namespace

Snapshot read_snapshot(const std::string& path, std::optional<std::int64_t> frame) {
    const h5::File file = h5::File::open(path);
    check_results_file(file);
    Snapshot s;
    s.frame = frame_meant(file, frame);
    s.origin = points(file.numbers("/talus", "origin")).at(0);
    s.time = file.read_rows<double>(frames_group + "time", s.frame, 1).at(0);
    s.name = file.read_texts("/talus/blocks/name");
    s.area = file.read<double>("/talus/blocks/area");
    s.position = points(file.read_rows<double>(frames_group + "position", s.frame, 1));
    s.angle = file.read_rows<double>(frames_group + "angle", s.frame, 1);
    s.removed = file.read_rows<std::uint8_t>(frames_group + "removed", s.frame, 1);
    read_shapes(file, s);
    return s;
}

}  // namespace talus
