#include "contact/cell_grid.hpp"

#include "contact/search_methods.hpp"

#include <bit>
#include <limits>
#include <utility>

namespace talus {

CoarseBox coarse(const Box& b, double margin) {
    return {rounded_down(b.xmin - margin), rounded_down(b.ymin - margin), -rounded_down(-(b.xmax + margin)),
            -rounded_down(-(b.ymax + margin))};
}

double wise_margin(int i, const Box& b, double speed, double typical, double least) {
    const double own = std::max(b.xmax - b.xmin, b.ymax - b.ymin) + 0.1 * typical;
    const double size = own < typical ? own : typical;
    const double varied = 0.75 + 0.5 * ((static_cast<std::uint32_t>(i) * 2654435769u) >> 8) * 0x1p-24;
    // What is listed too often and what is compared in vain cost the same at about this margin; half or twice of the 30
    // costs up to a tenth.
    return varied * std::clamp(std::sqrt(30.0 * speed * size), least * size, 0.6 * size);
}

std::vector<char> hubs(std::span<const Pair> neighbours, int n) {
    constexpr int many = 512;
    std::vector<int> count(n, 0);
    for (const Pair& pair : neighbours) ++count[pair.a], ++count[pair.b];
    std::vector<char> hub(n);
    for (int i = 0; i < n; ++i) hub[i] = count[i] > many;
    return hub;
}

void CellGrid::reset(int n, double width, double typical) {
    smallest_ = std::ldexp(typical, -12);
    mask_ = std::bit_ceil(static_cast<std::size_t>(std::max(n, 64))) - 1;
    for (int k = 0; k < level_count; ++k) {
        const double per_cell = 1.0 / std::ldexp(smallest_, k);
        const double across = std::clamp(width * per_cell, 3.0, 1e9);
        level_[k] = {per_cell, static_cast<std::size_t>(across) | 1, 7919u * static_cast<unsigned>(k), 0.0, 0};
    }
    levels_.clear();
    outsized_.clear();
    place_.assign(mask_ + 1, {});
    node_.assign(n, {{}, -1, 0, nowhere});
    question_ = 0;
}

int CellGrid::level_of(const CoarseBox& box) const {
    const double size = std::max(static_cast<double>(box.xmax) - box.xmin, static_cast<double>(box.ymax) - box.ymin);
    const double cells = 0.5 * size * level_[0].per_cell;
    const float far =
        std::max(std::max(std::abs(box.xmin), std::abs(box.xmax)), std::max(std::abs(box.ymin), std::abs(box.ymax)));
    if (!(cells < std::ldexp(1.0, level_count - 2)) || far > 1e30F) return outsized;
    return cells <= 1.0 ? 0 : std::ilogb(cells) + 1;
}

std::size_t CellGrid::place_of(const CoarseBox& b, int level) const {
    const double x = 0.5 * (static_cast<double>(b.xmin) + b.xmax), y = 0.5 * (static_cast<double>(b.ymin) + b.ymax);
    return place(cell(x, level_[level]), cell(y, level_[level]), level_[level]);
}

// All boxes whose centres may be near enough, whatever lies in between; how many. They stand at the begin of near_.
std::size_t CellGrid::gather(const CoarseBox& asked) {
    near_.resize(std::max(near_.size(), outsized_.size()));
    std::copy(outsized_.begin(), outsized_.end(), near_.begin());
    std::size_t near = outsized_.size();
    for (const int number : levels_)
        if (level_[number].population > 0) near = gather(asked, number, near);
    return near;
}

std::size_t CellGrid::gather(const CoarseBox& asked, int number, std::size_t near) {
    const Level& level = level_[number];
    const double reach = 0.5 * level.largest;
    const std::int64_t x0 = cell(asked.xmin - reach, level), x1 = cell(asked.xmax + reach, level);
    const std::int64_t y0 = cell(asked.ymin - reach, level), y1 = cell(asked.ymax + reach, level);
    const double cells = static_cast<double>(x1 - x0 + 1) * static_cast<double>(y1 - y0 + 1);
    if (cells > 4.0 * static_cast<double>(node_.size())) {
        near_.resize(std::max(near_.size(), near + node_.size()));
        for (int i = 0; i < static_cast<int>(node_.size()); ++i)
            if (node_[i].level == number) near_[near++] = i;
        return near;
    }
    for (std::int64_t y = y0; y <= y1; ++y) {
        near_.resize(std::max(near_.size(), near + 3 * static_cast<std::size_t>(x1 - x0 + 1)));
        for (std::int64_t x = x0; x <= x1; ++x) {
            const Place& here = place_[place(x, y, level)];
            for (const int i : here.box) {
                near_[near] = i;
                near += i >= 0;
            }
            for (int i = here.more; i >= 0; i = node_[i].next) {
                near_.resize(std::max(near_.size(), near + 4 * static_cast<std::size_t>(x1 - x0 + 1)));
                near_[near++] = i;
            }
        }
    }
    return near;
}

void CellGrid::insert(int i, const CoarseBox& box) {
    Node& node = node_[i];
    node.box = box;
    node.level = level_of(box);
    if (node.level == outsized) {
        outsized_.push_back(i);
        return;
    }
    Level& level = level_[node.level];
    if (std::find(levels_.begin(), levels_.end(), node.level) == levels_.end()) levels_.push_back(node.level);
    level.largest =
        std::max({level.largest, static_cast<double>(box.xmax) - box.xmin, static_cast<double>(box.ymax) - box.ymin});
    ++level.population;
    Place& place = place_[place_of(box, node.level)];
    for (int& room : place.box)
        if (room < 0) {
            room = i;
            return;
        }
    node.next = std::exchange(place.more, i);
}

void CellGrid::move(int i, const CoarseBox& box) {
    remove(i);
    insert(i, box);
}

void CellGrid::remove(int i) {
    Node& node = node_[i];
    if (node.level == outsized) {
        std::erase(outsized_, i);
    } else {
        --level_[node.level].population;
        Place& place = place_[place_of(node.box, node.level)];
        const auto room = std::find(place.box.begin(), place.box.end(), i);
        if (room != place.box.end()) {
            *room = place.more;  // the first of those that wait, if any
            if (place.more >= 0) place.more = node_[place.more].next;
        } else {
            int* link = &place.more;
            while (*link != i) link = &node_[*link].next;
            *link = node.next;
        }
    }
    node.level = nowhere;
}

std::vector<Pair> CellGrid::all_overlapping() const {
    std::vector<Box> boxes;
    boxes.reserve(node_.size());
    for (const Node& node : node_) {
        const CoarseBox& b = node.box;
        boxes.push_back(node.level == nowhere ? Box{1.0, 1.0, -1.0, -1.0} : Box{b.xmin, b.ymin, b.xmax, b.ymax});
    }
    std::vector<Pair> pairs;
    make_grid_search()->find(boxes, pairs);
    return pairs;
}

}  // namespace talus
