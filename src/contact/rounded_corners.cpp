#include "contact/rounded_corners.hpp"

#include "model/rounding.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

double eighth_power(double x) {
    const double square = x * x, fourth = square * square;
    return fourth * fourth;
}

struct Arc : CornerArc {
    Vec2 centre;  // m
};

struct Nearest {  // what of a part lies nearest to a point
    int edge;
    double distance;  // m, to the line of the edge; < 0 inside
    int corner;       // its arc; -1: the straight piece of the edge
};

class RoundedPart {
public:
    /// `at`: m, the centroid of its block.
    RoundedPart(const PlacedPart& placed, const Vec2& at, const Model& model)
        : part(placed), at_(at), cut_(&model.corners.cut[placed.first]) {}

    const PlacedPart& part;

    Vec2 tip(int i) const { return at_ + part.arm(i); }
    Vec2 direction(int edge) const { return perp(part.normal(edge)); }

    Arc arc(int i) const {
        const Vec2 &before = part.normal(part.previous(i)), &after = part.normal(i);
        const CornerArc own = corner_arc(before, after, cut_[i]);
        return {own, tip(i) + own.cut * direction(i) - own.radius * after};
    }

    Nearest nearest(const Vec2& point) const {
        Nearest found{0, -1e300, -1};
        for (int k = 0; k < part.n; ++k) {
            const double distance = part.normal(k).dot(point - at_) - part.offset[k];
            if (distance > found.distance) found = {k, distance, -1};
        }
        const int next = part.next(found.edge);
        const double along = direction(found.edge).dot(point - tip(found.edge));
        const Arc first = arc(found.edge), last = arc(next);
        // Behind the centre of an arc there is only the edge left to press.
        const auto before_centre = [&](const Arc& arc) { return part.normal(found.edge).dot(point - arc.centre) > 0.0; };
        if (along < first.cut && before_centre(first)) found.corner = found.edge;
        if (along > part.length[found.edge] - last.cut && before_centre(last)) found.corner = next;
        return found;
    }

private:
    Vec2 at_;
    const double* cut_;  // [n] m
};

struct PointSpring {
    Vec2 at, normal;  // m, from the centroid of block a; unit, from a to b
    double overlap;   // m
    double length;    // m
};

class RoundedPair {
public:
    RoundedPair(const Model& model, const PlacedPart& a, const PlacedPart& b, double dx, double dy)
        : a_(a, Vec2::Zero(), model), b_(b, Vec2(dx, dy), model), shortest_(model.rounding_length) {}

    template <class Visit>
    void for_each_spring(Visit&& visit) const {
        for (int i = 0; i < a_.part.n; ++i) {
            const Arc arc = a_.arc(i);
            const Nearest on_b = b_.nearest(arc.centre);
            if (on_b.distance >= arc.radius) continue;
            if (const int j = corner_of_b(i, on_b); j >= 0)
                visit_overlap(arc, b_.arc(j), visit);
            else if (on_b.corner < 0)
                visit_if_pressed(arc, Vec2(-b_.part.normal(on_b.edge)), arc.radius - on_b.distance, 1.0, visit);
        }
        for (int j = 0; j < b_.part.n; ++j) {
            const Arc arc = b_.arc(j);
            const Nearest on_a = a_.nearest(arc.centre);
            if (on_a.distance >= arc.radius || on_a.corner >= 0) continue;
            if (meet(on_a.edge, j) || meet(a_.part.next(on_a.edge), j)) continue;
            visit_if_pressed(arc, a_.part.normal(on_a.edge), arc.radius - on_a.distance, -1.0, visit);
        }
    }

private:
    /// Corner of b against which corner i of a is pressed; -1 = none.
    int corner_of_b(int i, const Nearest& on_b) const {
        if (on_b.corner >= 0) return meet(i, on_b.corner) ? on_b.corner : -1;
        for (const int j : {on_b.edge, b_.part.next(on_b.edge)})
            if (meet(i, j)) return j;
        return -1;
    }

    /// Whether corners i of a and j of b touch each other with their arcs: each is nearest to the arc of the other. Or
    /// each to the edge of the other that runs the same way from there: where two tips lie above each other and the edges
    /// are not quite parallel, that would be two springs in place of one.
    bool meet(int i, int j) const {
        const Nearest on_b = b_.nearest(a_.arc(i).centre), on_a = a_.nearest(b_.arc(j).centre);
        if (on_b.corner >= 0 || on_a.corner >= 0) return on_b.corner == j && on_a.corner == i;
        return (on_a.edge == i && on_b.edge == b_.part.previous(j)) || (on_a.edge == a_.part.previous(i) && on_b.edge == j);
    }

    template <class Visit>
    void visit_overlap(const Arc& a, const Arc& b, Visit& visit) const {
        const Vec2 way = b.centre - a.centre;
        const double distance = way.norm();
        if (distance > 0.0) visit_if_pressed(a, Vec2(way / distance), a.radius + b.radius - distance, 1.0, visit);
    }

    /// `side`: 1 = the arc belongs to a, -1 = to b.
    template <class Visit>
    void visit_if_pressed(const Arc& arc, const Vec2& normal, double overlap, double side, Visit& visit) const {
        if (overlap <= 0.0) return;
        const Vec2 at = arc.centre + side * (arc.radius - 0.5 * overlap) * normal;
        visit(PointSpring{at, normal, overlap, std::max(0.5 * facing_length(normal), shortest_)});
    }

    /// m, over which a and b face each other across the normal: all edges of a against all of b, each weighted with a
    /// power of the cosine between it and the normal, so that nothing jumps when a block turns. With the 8th an edge at 45
    /// degrees counts with a sixteenth, one at 60 not at all; with the 4th a quarter and a sixteenth, and with the 16th a
    /// block that has tilted by 15 degrees has lost half of its length.
    double facing_length(const Vec2& normal) const {
        const Vec2 along = perp(normal);
        double sum = 0.0;
        for (int e = 0; e < a_.part.n; ++e) {
            const double faces_b = a_.part.normal(e).dot(normal);
            if (faces_b <= 0.0) continue;
            const double a0 = along.dot(a_.tip(e)), a1 = along.dot(a_.tip(a_.part.next(e)));
            for (int k = 0; k < b_.part.n; ++k) {
                const double faces_a = -b_.part.normal(k).dot(normal);
                if (faces_a <= 0.0) continue;
                const double b1 = along.dot(b_.tip(k)), b0 = along.dot(b_.tip(b_.part.next(k)));
                const double common = std::min(a1, b1) - std::max(a0, b0);
                if (common > 0.0) sum += common * eighth_power(faces_a * faces_b);
            }
        }
        return sum;
    }

    RoundedPart a_, b_;
    double shortest_;  // m
};

}  // namespace

Pressed rounded_contact(const Model& model, const PlacedPart& a, const PlacedPart& b, double dx, double dy) {
    Pressed p;
    double stretched = 0.0, second = 0.0;  // m2, Sum L u; m3, Sum L |at|^2
    Vec2 force = Vec2::Zero(), centre = Vec2::Zero(), middle = Vec2::Zero(), normal = Vec2::Zero();
    const Vec2 to_b(dx, dy);
    RoundedPair(model, a, b, dx, dy).for_each_spring([&](const PointSpring& s) {
        const double size = s.length * s.overlap;
        const Vec2 f = size * s.normal;
        force += f;
        p.torque_a += cross(s.at, f);
        p.torque_b += cross(Vec2(s.at - to_b), f);
        centre += size * s.at;
        middle += s.length * s.at;
        second += s.length * s.at.squaredNorm();
        p.length += s.length;
        stretched += size;
        normal = s.normal;
    });
    if (p.length == 0.0) return p;
    centre /= stretched;
    p.fx = force.x(), p.fy = force.y();
    p.x = centre.x(), p.y = centre.y();
    p.overlap = stretched / p.length;
    p.rotation_stiffness = std::max(second - middle.squaredNorm() / p.length, 0.0);
    p.along_normal = force.norm();
    if (p.along_normal > 0.0) normal = force / p.along_normal;
    p.nx = normal.x(), p.ny = normal.y();
    return p;
}

double rounded_energy(const Model& model, const PlacedPart& a, const PlacedPart& b, double dx, double dy) {
    double energy = 0.0;
    RoundedPair(model, a, b, dx, dy).for_each_spring([&](const PointSpring& s) {
        energy += 0.5 * s.length * s.overlap * s.overlap;
    });
    return energy;
}

}  // namespace talus
