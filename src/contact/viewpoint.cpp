#include "contact/viewpoint.hpp"

#include "contact/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace {

double at_rank(std::vector<double>& values, double share) {
    if (values.empty()) return 0.0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

double median(std::span<double> values) {
    const auto middle = values.begin() + std::ssize(values) / 2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

void Viewpoint::choose(std::span<const Box> boxes) {
    std::vector<double> x, y, size, far;
    for (const Box& b : boxes) {
        if (!present(b)) continue;
        x.push_back(0.5 * b.xmin + 0.5 * b.xmax);
        y.push_back(0.5 * b.ymin + 0.5 * b.ymax);
        size.push_back(std::max(b.xmax - b.xmin, b.ymax - b.ymin));
    }
    centre_ = {at_rank(x, 0.5), at_rank(y, 0.5)};
    typical_ = at_rank(size, 0.5);
    if (!(typical_ > 0.0 && typical_ < 1e30)) typical_ = 1.0;
    if (!(std::abs(centre_.x()) < 1e30 && std::abs(centre_.y()) < 1e30)) centre_ = {0.0, 0.0};
    for (const Box& each : boxes) {
        if (!present(each)) continue;
        const Box b = seen(each);
        far.push_back(std::max(std::max(std::abs(b.xmin), std::abs(b.xmax)), std::max(std::abs(b.ymin), std::abs(b.ymax))));
    }
    far_ = std::min(8.0 * (at_rank(far, 0.98) + typical_), 1e30);
    guard_ = 2.0 * rounding();
}

double Viewpoint::rounding() const { return 0x1p-48 * (far_ + std::abs(centre_.x()) + std::abs(centre_.y())); }

void Viewpoint::follow(std::span<const Box> boxes, bool calm) {
    if (!calm) {
        if (following_ == 0) sample_.fill(Vec2::Constant(std::numeric_limits<double>::quiet_NaN()));
        following_ = patience;
    }
    if (following_ == 0) return;
    --following_;
    const int count_of_boxes = static_cast<int>(boxes.size());
    const int every = std::max(1, count_of_boxes / sample_size);
    std::array<std::array<double, sample_size>, 2> moved;
    int count = 0;
    for (int k = 0; k < sample_size && k * every < count_of_boxes; ++k) {
        const Box& b = boxes[k * every];
        const Vec2 now(0.5 * b.xmin + 0.5 * b.xmax, 0.5 * b.ymin + 0.5 * b.ymax);
        const Vec2 step = now - sample_[k];
        sample_[k] = now;
        if (!std::isfinite(step.x() + step.y())) continue;
        moved[0][count] = step.x();
        moved[1][count++] = step.y();
    }
    if (count == 0) return;
    Vec2 common;
    for (int axis = 0; axis < 2; ++axis) {
        const std::span all(moved[axis].data(), count);
        const double middle = median(all);
        for (double& each : all) each = std::abs(each - middle);
        common[axis] = std::abs(middle) > 4.0 * median(all) ? middle : 0.0;
    }
    if (common.isZero() || common.cwiseAbs().maxCoeff() > typical_) return;
    centre_ += common;
    following_ = patience;
}

}  // namespace talus
