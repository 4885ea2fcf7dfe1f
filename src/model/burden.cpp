#include "model/burden.hpp"

#include "geometry/box_tree.hpp"
#include "geometry/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

namespace talus {
namespace {

// Gaps below this share of a block are those of coordinates that were typed in.
constexpr double touching = 1e-6;

double largest(const TimeTable& x, const TimeTable& y) {
    double most = std::hypot(x(0.0), y(0.0));
    for (const double t : x.time) most = std::max(most, std::hypot(x(t), y(t)));
    for (const double t : y.time) most = std::max(most, std::hypot(x(t), y(t)));
    return most;
}

/// Largest mean over any `span` (s) that begins, ends or has its middle at a point of the tables.
double largest_mean(const TimeTable& x, const TimeTable& y, double span) {
    double most = 0.0;
    for (const TimeTable* table : {&x, &y})
        for (const double t : table->time)
            for (const double side : {-0.5, 0.0, 0.5}) {
                const double middle = std::max(t + side * span, 0.5 * span);
                most = std::max(most, std::hypot(x.mean(middle, span), y.mean(middle, span)));
            }
    return most;
}

double speed_of(const Model& model, const State& state, BlockId b) {
    return state.motion.velocity[b].norm() + std::abs(state.motion.spin[b]) * model.blocks.radius[b];
}

// m, largest distance between two parts across an edge of the first: no less than the gap across the edge that parts them.
double gap(const Model& model, PartId p, PartId q) {
    double most = -std::numeric_limits<double>::infinity();
    const Vec2 apart = model.blocks.start[model.parts.block[q]] - model.blocks.start[model.parts.block[p]];
    for (int k = model.parts.first_corner[p]; k < model.parts.first_corner[p + 1]; ++k) {
        double nearest = std::numeric_limits<double>::infinity();
        for (int c = model.parts.first_corner[q]; c < model.parts.first_corner[q + 1]; ++c)
            nearest = std::min(nearest, model.corners.normal[k].dot(apart + model.corners.arm[c]) - model.corners.offset[k]);
        most = std::max(most, nearest);
    }
    return most;
}

/// [nb] a block of the cluster of blocks that touch each other, the same one for all of its blocks.
std::vector<BlockId> clusters(const Model& model) {
    std::vector<Box> boxes(model.parts.size());
    for (PartId p = 0; p < model.parts.size(); ++p) {
        const BlockId b = model.parts.block[p];
        std::vector<Vec2> corner;
        for (int k = model.parts.first_corner[p]; k < model.parts.first_corner[p + 1]; ++k)
            corner.push_back(model.blocks.start[b] + model.corners.arm[k]);
        boxes[p] = bounds(corner).grown(touching * std::sqrt(model.blocks.area[b]));
    }
    const BoxTree tree(boxes);
    std::vector<BlockId> parent(model.blocks.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](BlockId b) {
        while (parent[b] != b) b = parent[b] = parent[parent[b]];
        return b;
    };
    for (PartId p = 0; p < model.parts.size(); ++p) {
        tree.overlapping(boxes[p], [&](PartId q) {
            const BlockId a = root(model.parts.block[p]), b = root(model.parts.block[q]);
            if (p < q && a != b && std::max(gap(model, p, q), gap(model, q, p)) <= touching * model.parts.thickness[p])
                parent[b] = a;
        });
    }
    for (BlockId& b : parent) b = root(b);
    return parent;
}

bool driven(const Model& model, BlockId b) {
    return std::any_of(model.driven.begin(), model.driven.end(), [&](const DrivenBlock& d) { return d.block == b; });
}

double height(const Model& model) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        low = std::min(low, model.blocks.start[b].y() - model.blocks.radius[b]);
        high = std::max(high, model.blocks.start[b].y() + model.blocks.radius[b]);
    }
    return high - low;
}

}  // namespace

double Burden::closure(double kn) const {
    return std::max(stress / (kn * mean_size), std::cbrt(1.5 * density * speed * speed / (kn * mean_size)));
}

double Burden::stiffness(double closure) const {
    return std::max(stress / (closure * mean_size), 1.5 * density * speed * speed / (std::pow(closure, 3) * mean_size));
}

Burden burden_of(const Scenario& scenario, const Model& model, const State& state) {
    Burden burden;
    const Blocks& blocks = model.blocks;
    double mass = 0.0, area = 0.0, smallest = std::numeric_limits<double>::infinity(), fastest = 0.0;
    for (BlockId b = 0; b < blocks.size(); ++b) {
        mass += blocks.mass[b], area += blocks.area[b];
        if (blocks.held(b)) continue;
        smallest = std::min(smallest, blocks.area[b]);
        fastest = std::max(fastest, speed_of(model, state, b));
    }
    if (area == 0.0) return burden;
    burden.density = mass / area;
    burden.mean_size = std::sqrt(area / blocks.size());
    burden.smallest_size = std::isfinite(smallest) ? std::sqrt(smallest) : burden.mean_size;
    burden.gravity = largest(model.gravity_x, model.gravity_y);
    for (const StageSpec& stage : scenario.stages)
        if (stage.gravity) burden.gravity = std::max(burden.gravity, largest(stage.gravity->x, stage.gravity->y));
    burden.layers = height(model) / burden.mean_size;
    burden.stress = burden.density * burden.gravity * height(model);
    for (const JointFace& face : model.faces)
        burden.stress = std::max({burden.stress, std::abs(face.sigma0), std::abs(face.sigma1)});
    for (const Load& load : model.loads)
        burden.stress += largest(load.force_x, load.force_y) / std::sqrt(blocks.area[load.block]);
    if (blocks_fly(model, state)) burden.speed = std::sqrt(fastest * fastest + 2.0 * burden.gravity * height(model));
    return burden;
}

double step_of_fall(const Model& model, std::span<const Load> loads, double share) {
    const Blocks& blocks = model.blocks;
    double smallest = std::numeric_limits<double>::infinity();
    for (BlockId b = 0; b < blocks.size(); ++b)
        if (!blocks.held(b)) smallest = std::min(smallest, blocks.area[b]);
    const double size = std::isfinite(smallest) ? std::sqrt(smallest) : 1.0;
    const auto within = [&](double gravity) { return share * std::sqrt(size / std::max(gravity, 1.0)); };
    const auto longest = [&](double dt) {  // if loads and weight act as in the worst step of this length
        const double gravity = largest_mean(model.gravity_x, model.gravity_y, dt);
        std::vector<double> pull(blocks.size(), gravity);  // m/s2, of the farthest corner
        double step = within(gravity);
        for (const Load& load : loads) {
            const BlockId b = load.block;
            if (blocks.held(b)) continue;
            pull[b] += largest_mean(load.force_x, load.force_y, dt) / blocks.mass[b] +
                       largest_mean(load.moment, {}, dt) / blocks.inertia[b] * blocks.radius[b];
            step = std::min(step, share * std::sqrt(std::sqrt(blocks.area[b]) / std::max(pull[b], 1.0)));
        }
        return step;
    };
    double dt = within(std::hypot(model.gravity_x(0.0), model.gravity_y(0.0)));
    for (double step = longest(dt); step < dt; step = longest(dt)) dt = std::max(step, 0.5 * dt);
    return dt;
}

bool blocks_fly(const Model& model, const State& state) {
    int free = 0;
    bool thrown = false;
    for (BlockId b = 0; b < model.blocks.size(); ++b) {
        if (model.blocks.held(b) || driven(model, b)) continue;
        ++free;
        thrown = thrown || speed_of(model, state, b) > 0.0;
    }
    if (thrown && free > 1) return true;
    if (!thrown && largest(model.gravity_x, model.gravity_y) == 0.0) return false;
    const std::vector<BlockId> cluster = clusters(model);
    std::vector<std::uint8_t> supported(model.blocks.size(), 0);
    for (BlockId b = 0; b < model.blocks.size(); ++b)
        if (model.blocks.inv_mass[b].minCoeff() == 0.0 || driven(model, b)) supported[cluster[b]] = 1;
    const bool something_to_hit = std::any_of(supported.begin(), supported.end(), [](std::uint8_t s) { return s != 0; });
    for (BlockId b = 0; b < model.blocks.size() && something_to_hit; ++b)
        if (!supported[cluster[b]]) return true;
    return false;
}

}  // namespace talus
