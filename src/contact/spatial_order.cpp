#include "contact/spatial_order.hpp"

#include "contact/search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace talus {
namespace {

constexpr int levels = 16, typical_level = 8;

/// Level k holds sizes of half to twice of 4^(k - 8) typical ones.
int level_of(const Box& b, double typical) {
    const double size = std::max(b.xmax - b.xmin, b.ymax - b.ymin) / typical;
    const int twofold = std::ilogb(2.0 * std::clamp(size, std::ldexp(1.0, -2 * levels), std::ldexp(1.0, 2 * levels)));
    return std::clamp((twofold + 2 * typical_level) / 2, 0, levels - 1);
}

double size_at(int level, double typical) { return std::ldexp(typical, 2 * (level - typical_level)); }

/// Where the middles of boxes lie along one axis, cut into equal pieces.
class Cuts {
public:
    Cuts(double low, double high, double width, int most)
        : low_(low),
          count_(static_cast<int>(std::clamp((high - low) / width + 1.0, 1.0, static_cast<double>(most)))),
          per_piece_(high > low ? std::min(1.0 / width, count_ / (high - low)) : 0.0) {}
    int count() const { return count_; }
    int of(double at) const { return std::clamp(static_cast<int>((at - low_) * per_piece_), 0, count_ - 1); }

private:
    double low_;
    int count_;
    double per_piece_;
};

struct Site {
    float x, y;  // m, middle as seen; no further out than is usual
    int level;   // -1 = not present
};

struct Scene {
    std::vector<Site> sites;
    std::array<int, levels> population{};
    Vec2 low, high;  // m

    Scene(std::span<const Box> boxes, const Viewpoint& view) {
        const double far = 4.0 * view.width();
        low = Vec2::Constant(std::numeric_limits<double>::infinity()), high = -low;
        sites.reserve(boxes.size());
        for (const Box& each : boxes) {
            Site& site = sites.emplace_back(Site{0.0F, 0.0F, -1});
            if (!present(each)) continue;
            const Box b = view.seen(each);
            const auto middle = [&](double lower, double upper) {
                const double at = 0.5 * lower + 0.5 * upper;
                return static_cast<float>(at > -far ? std::min(at, far) : -far);  // what is not a number too
            };
            site = {middle(b.xmin, b.xmax), middle(b.ymin, b.ymax), level_of(b, view.typical())};
            ++population[site.level];
            const Vec2 at(site.x, site.y);
            low = low.cwiseMin(at), high = high.cwiseMax(at);
        }
    }
};

}  // namespace

std::vector<int> spatial_order(std::span<const Box> boxes, const Viewpoint& view, int together) {
    const Scene scene(boxes, view);
    const int n = static_cast<int>(boxes.size());
    const auto at_most = [](int population) { return 4 * population + 64; };
    // A quarter of a box is fine enough: boxes of one piece stand in any order.
    const Cuts heights(scene.low.y(), scene.high.y(), 0.25 * view.typical(), at_most(n));
    std::vector<Cuts> columns;
    std::array<int, levels + 1> first_column{};
    for (int k = 0; k < levels; ++k) {
        const double width = std::sqrt(static_cast<double>(together)) * size_at(k, view.typical());
        columns.emplace_back(scene.low.x(), scene.high.x(), width, at_most(scene.population[k]));
        first_column[k + 1] = first_column[k] + (scene.population[k] > 0 ? columns[k].count() : 0);
    }

    // By height, then by column: the second sorting keeps the order of the first.
    std::vector<int> column(n, -1), height(n), by_height(n), from(heights.count() + 1, 0),
        place(first_column[levels] + 1, 0);
    for (int i = 0; i < n; ++i) {
        const Site& site = scene.sites[i];
        if (site.level < 0) continue;
        column[i] = first_column[site.level] + columns[site.level].of(site.x);
        const int up = heights.of(site.y);
        height[i] = column[i] % 2 == 0 ? up : heights.count() - 1 - up;
        ++from[height[i]];
        ++place[column[i]];
    }
    for (int next = 0; int& of_height : from) next += std::exchange(of_height, next);
    for (int i = 0; i < n; ++i)
        if (column[i] >= 0) by_height[from[height[i]]++] = i;
    int next = 0;
    for (int k = 0; k < levels; ++k) {
        next = (next + together - 1) / together * together;
        for (int c = first_column[k]; c < first_column[k + 1]; ++c) next += std::exchange(place[c], next);
    }
    std::vector<int> order((next + together - 1) / together * together, -1);
    const int sorted = from.back();
    for (int k = 0; k < sorted; ++k) order[place[column[by_height[k]]]++] = by_height[k];
    return order;
}

}  // namespace talus
