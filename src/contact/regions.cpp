#include "contact/regions.hpp"

#include "contact/cell_grid.hpp"

#include <algorithm>
#include <cmath>

namespace talus {

double farthest(const Box& a, const Box& b) {
    return std::max(std::max(std::abs(a.xmin - b.xmin), std::abs(a.xmax - b.xmax)),
                    std::max(std::abs(a.ymin - b.ymin), std::abs(a.ymax - b.ymax)));
}

void Regions::start(int n, int step, double speed) {
    at.resize(4 * static_cast<std::size_t>(n));
    radius.assign(n, -1.0F);
    if (std::ssize(track) != n) track.assign(n, {static_cast<float>(speed), step});
    for (Track& each : track) each.since = step;
}

void Regions::move(int i, const Box& seen, int step, const Viewpoint& view) {
    const double now = speed(i, seen, step);
    track[i] = {view.believable(now) ? static_cast<float>(now) : 0.0F, step};
    float* bounds = &at[4 * static_cast<std::size_t>(i)];
    bounds[0] = static_cast<float>(seen.xmin), bounds[1] = static_cast<float>(seen.ymin);
    bounds[2] = static_cast<float>(seen.xmax), bounds[3] = static_cast<float>(seen.ymax);
}

void Regions::close(int i, double most, const Viewpoint& view) {
    radius[i] = view.ordinary(reference(i)) ? rounded_down(most) : -1.0F;
}

void Regions::leave_out(int i, const Box& seen, int step, const Viewpoint& view) {
    move(i, seen, step, view);
    track[i].speed = 0.0F;
    const Box b = reference(i);
    const double missing = std::max(b.xmin - b.xmax, b.ymin - b.ymax);  // how far from being present
    close(i, missing > 0.0 ? 0.25 * missing : -1.0, view);
}

std::vector<float> Regions::speeds() const {
    std::vector<float> speeds;
    speeds.reserve(track.size());
    for (const Track& each : track) speeds.push_back(each.speed);
    return speeds;
}

void Regions::expect(const std::vector<float>& speeds) {
    track.clear();
    for (const float speed : speeds) track.push_back({speed, 0});
}

}  // namespace talus
