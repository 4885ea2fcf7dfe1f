#include "model/placed_joint.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace talus {
namespace {

struct Edge {
    Vec2 from, to;
    double length() const { return (to - from).norm(); }
    double distance(const Vec2& p) const {
        const Vec2 along = to - from;
        const double t = std::clamp((p - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
        return (p - from - t * along).norm();
    }
};

/// The edge that starts at this corner, where it is now.
Edge edge_at(const Model& model, const State& state, PartId part, int corner) {
    const int first = model.parts.first_corner[part], last = model.parts.first_corner[part + 1];
    const MaterialPoint from{model.parts.block[part], model.corners.arm[corner]};
    const MaterialPoint to{model.parts.block[part], model.corners.arm[corner + 1 < last ? corner + 1 : first]};
    return {from.now(state), to.now(state)};
}

struct Nearest {
    double distance = std::numeric_limits<double>::infinity();
    PartId part = -1;
    int corner = -1;
};

/// Part whose boundary comes nearest to the place; parts of `except` are passed over.
Nearest nearest_edge(const Model& model, const State& state, const Vec2& place, BlockId except) {
    Nearest nearest;
    for (PartId p = 0; p < model.parts.size(); ++p) {
        if (model.parts.block[p] == except) continue;
        for (int c = model.parts.first_corner[p]; c < model.parts.first_corner[p + 1]; ++c) {
            if (model.corners.internal[c]) continue;
            const double distance = edge_at(model, state, p, c).distance(place);
            if (distance < nearest.distance) nearest = {distance, p, c};
        }
    }
    return nearest;
}

/// Corner whose edge looks most along the direction; -1 if none does within 5 degrees.
int edge_towards(const Model& model, const State& state, PartId part, const Vec2& direction) {
    const double angle = state.motion.angle[model.parts.block[part]];
    int best = -1;
    double largest = std::cos(radians(5.0));
    for (int c = model.parts.first_corner[part]; c < model.parts.first_corner[part + 1]; ++c) {
        const double cosine = turned(model.corners.normal[c], angle).dot(direction);
        if (cosine > largest) largest = cosine, best = c;
    }
    return best;
}

/// The two edges that lie on each other, found from the normal: the general law does not name them.
std::optional<std::pair<Edge, Edge>> facing_edges(const Model& model, const State& state, const Contact& c) {
    const int a = edge_towards(model, state, c.part_a, c.normal), b = edge_towards(model, state, c.part_b, -c.normal);
    if (a < 0 || b < 0) return std::nullopt;
    return std::pair(edge_at(model, state, c.part_a, a), edge_at(model, state, c.part_b, b));
}

Vec2 relative_displacement(const PlacedJoint& joint, const State& s) {
    return joint.on_b.displacement(s) - joint.on_a.displacement(s);
}

Vec2 normal_now(const PlacedJoint& joint, const State& s) { return turned(joint.normal, s.motion.angle[joint.on_a.block]); }

}  // namespace

const Contact* PlacedJoint::contact(const State& s) const {
    const auto key = [](const Contact& c) { return std::pair(c.part_a, c.part_b); };
    const auto wanted = std::pair(part_a, part_b);
    const auto& list = s.contacts.list;
    const auto found =
        std::lower_bound(list.begin(), list.end(), wanted, [&](const Contact& c, const auto& k) { return key(c) < k; });
    return found != list.end() && key(*found) == wanted ? &*found : nullptr;
}

double PlacedJoint::opening(const State& s) const { return relative_displacement(*this, s).dot(normal_now(*this, s)); }

double PlacedJoint::shear_displacement(const State& s) const {
    return relative_displacement(*this, s).dot(perp(normal_now(*this, s)));
}

PlacedJoint joint_near(const Model& model, const State& state, const Vec2& place) {
    Nearest a = nearest_edge(model, state, place, -1);
    Nearest b = nearest_edge(model, state, place, model.parts.block[a.part]);
    if (b.part < a.part) std::swap(a, b);
    return {a.part, b.part, fixed_to(state, model.parts.block[a.part], place),
            fixed_to(state, model.parts.block[b.part], place), model.corners.normal[a.corner]};
}

double max_normal_stress(const Model& model, const State& state, const Contact& c) {
    if (c.length <= 0.0) return 0.0;
    const double triangular = 2.0 * c.normal_force / c.length;
    const auto edges = facing_edges(model, state, c);
    if (!edges) return triangular;
    const auto& [a, b] = *edges;
    const Vec2 along = (a.to - a.from) / a.length();
    const auto place = [&along, from = a.from](const Vec2& p) { return (p - from).dot(along); };
    const double low = std::max(0.0, std::min(place(b.from), place(b.to)));
    const double high = std::min(a.length(), std::max(place(b.from), place(b.to)));
    if (c.length < (1.0 - 1e-6) * (high - low)) return triangular;
    const double eccentricity = std::abs(place(c.point) - 0.5 * (low + high));
    return c.normal_force / c.length * (1.0 + 6.0 * eccentricity / c.length);
}

}  // namespace talus
