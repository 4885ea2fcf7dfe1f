#include "contact/distance_potential.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

struct Line {  // depth below edge k of P along an edge of Q: D + s t, t in [0, 1]
    double depth, slope;
};

// Visits every stretch of the edges of Q that lies inside P and is nearest to one edge of P: visit(e, k, t1, t2, f1, f2)
// gets the edge of Q, that of P, the ends of the stretch along the edge of Q, in [0, 1], and the depths there. Q is shifted
// by (qx, qy), P by (px, py), both from the centroid of a.
template <class Visit>
[[gnu::always_inline]] inline void stretches(const PlacedPart& q, double qx, double qy, const PlacedPart& p, double px,
                                             double py, Visit&& visit) {
    constexpr int few = 16;  // parts with more edges than this are rare and may allocate
    Line some[few];
    std::vector<Line> many(p.n > few ? p.n : 0);
    Line* const lines = p.n > few ? many.data() : some;
    for (int e = 0; e < q.n; ++e) {
        if (q.internal[e]) continue;
        const Vec2& from = q.arm(e);
        const Vec2& to = q.arm(q.next(e));
        const double ax = from.x() + (qx - px), ay = from.y() + (qy - py);
        const double ux = to.x() - from.x(), uy = to.y() - from.y();
        double lo = 0.0, hi = 1.0;
        for (int k = 0; k < p.n && lo < hi; ++k) {
            const double depth = p.offset[k] - (p.normal(k).x() * ax + p.normal(k).y() * ay);
            const double slope = -(p.normal(k).x() * ux + p.normal(k).y() * uy);
            lines[k] = {depth, slope};
            const double end = depth + slope;
            if (depth > 0.0 && end > 0.0) continue;  // the usual case: edge k does not cut this edge
            if (depth <= 0.0 && end <= 0.0)
                hi = lo;
            else if (slope > 0.0)
                lo = std::max(lo, -depth / slope);
            else
                hi = std::min(hi, -depth / slope);
        }
        if (!(lo < hi)) continue;

        // Walk along the lower envelope of the lines from lo to hi.
        int k = -1;
        double best = 0.0;
        for (int j = 0; j < p.n; ++j) {
            const double depth = lines[j].depth + lines[j].slope * lo;
            if (k < 0 || depth < best || (depth == best && lines[j].slope < lines[k].slope)) best = depth, k = j;
        }
        double t = lo;
        while (t < hi) {
            double end = hi;
            int following = -1;
            for (int j = 0; j < p.n; ++j) {
                if (!(lines[j].slope < lines[k].slope)) continue;
                const double crossing = (lines[j].depth - lines[k].depth) / (lines[k].slope - lines[j].slope);
                if (crossing < end || (crossing == end && following >= 0 && lines[j].slope < lines[following].slope)) {
                    end = std::max(crossing, t);
                    following = j;
                }
            }
            const double f1 = std::max(lines[k].depth + lines[k].slope * t, 0.0);
            const double f2 = std::max(lines[k].depth + lines[k].slope * end, 0.0);
            visit(e, k, t, end, f1, f2);
            t = end;
            if (following < 0) break;
            k = following;
        }
    }
}

// Adds -sign/2 x Int d_P ds x normal over all edges of Q inside P; sign is +1 where Q is block b (force on b) and -1 where Q
// is block a (the reaction falls on b).
void integrate(const PlacedPart& q, double qx, double qy, const PlacedPart& p, double px, double py, double sign, double dx,
               double dy, Pressed& patch, double& weight) {
    stretches(q, qx, qy, p, px, py, [&](int e, int, double t, double end, double f1, double f2) {
        if (f1 + f2 > 0.0) {
            const Vec2 &from = q.arm(e), &to = q.arm(q.next(e));
            const double integral = 0.5 * q.length[e] * (end - t) * (f1 + f2);
            const double at = t + (end - t) * (f1 + 2.0 * f2) / (3.0 * (f1 + f2));
            const double x = from.x() + qx + at * (to.x() - from.x()), y = from.y() + qy + at * (to.y() - from.y());
            const double fx = -0.5 * sign * integral * q.normal(e).x();
            const double fy = -0.5 * sign * integral * q.normal(e).y();
            patch.fx += fx;
            patch.fy += fy;
            patch.torque_a += x * fy - y * fx;
            patch.torque_b += (x - dx) * fy - (y - dy) * fx;
            patch.x += integral * x;
            patch.y += integral * y;
            weight += integral;
        }
        patch.length += 0.5 * q.length[e] * (end - t);
    });
}

Polygon clip(const Polygon& polygon, double nx, double ny, double offset) {  // keeps n . x <= offset
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec2& u = polygon[i];
        const Vec2& v = polygon[(i + 1) % polygon.size()];
        const double du = offset - (nx * u.x() + ny * u.y()), dv = offset - (nx * v.x() + ny * v.y());
        if (du >= 0.0) kept.push_back(u);
        if ((du > 0.0 && dv < 0.0) || (du < 0.0 && dv > 0.0)) kept.push_back(u + (v - u) * (du / (du - dv)));
    }
    return kept;
}

// Int over the polygon of (offset - n . x)
double depth_integral(const Polygon& polygon, double nx, double ny, double offset) {
    double area = 0.0;
    Vec2 moment = Vec2::Zero();
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const double triangle = 0.5 * cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
        area += triangle;
        moment += triangle * (polygon[0] + polygon[i] + polygon[i + 1]) / 3.0;
    }
    return area * offset - nx * moment.x() - ny * moment.y();
}

// Int over the region of d_P: the cell of edge k is where k is nearest
double potential(const Polygon& region, const PlacedPart& p, double px, double py) {
    double sum = 0.0;
    for (int k = 0; k < p.n; ++k) {
        const double offset_k = p.offset[k] + p.normal(k).x() * px + p.normal(k).y() * py;
        Polygon cell = region;
        for (int j = 0; j < p.n && cell.size() > 2; ++j) {
            if (j == k) continue;
            const double offset_j = p.offset[j] + p.normal(j).x() * px + p.normal(j).y() * py;
            // offset_k - n_k.x <= offset_j - n_j.x
            cell = clip(cell, p.normal(j).x() - p.normal(k).x(), p.normal(j).y() - p.normal(k).y(), offset_j - offset_k);
        }
        if (cell.size() > 2) sum += depth_integral(cell, p.normal(k).x(), p.normal(k).y(), offset_k);
    }
    return sum;
}

}  // namespace

Pressed distance_potential(const PlacedPart& a, const PlacedPart& b, double dx, double dy) {
    Pressed patch;
    double weight = 0.0;
    integrate(b, dx, dy, a, 0.0, 0.0, 1.0, dx, dy, patch, weight);
    integrate(a, 0.0, 0.0, b, dx, dy, -1.0, dx, dy, patch, weight);
    patch.along_normal = std::sqrt(patch.fx * patch.fx + patch.fy * patch.fy);
    if (!(weight > 0.0 && patch.along_normal > 0.0)) return {};
    patch.nx = patch.fx / patch.along_normal;
    patch.ny = patch.fy / patch.along_normal;
    patch.x /= weight;
    patch.y /= weight;
    patch.overlap = weight / (2.0 * patch.length);
    return patch;
}

void distance_potential_springs(const PlacedPart& a, const PlacedPart& b, double dx, double dy, PressedSprings& found) {
    const auto add = [&](const PlacedPart& q, double qx, double qy, const PlacedPart& p, double px, double py, double sign) {
        stretches(q, qx, qy, p, px, py, [&](int e, int k, double t1, double t2, double, double) {
            const Vec2 &from = q.arm(e), &to = q.arm(q.next(e));
            for (const double gauss : {-0.5, 0.5}) {  // two points integrate what is linear times linear
                const double at = 0.5 * (t1 + t2) + (t2 - t1) * gauss / std::sqrt(3.0);
                found.springs.push_back({0.25 * q.length[e] * (t2 - t1), from + at * (to - from) + Vec2(qx, qy),
                                         -sign * q.normal(e), sign * p.normal(k)});
            }
        });
    };
    add(b, dx, dy, a, 0.0, 0.0, 1.0);
    add(a, 0.0, 0.0, b, dx, dy, -1.0);
}

double distance_potential_energy(const PlacedPart& a, const PlacedPart& b, double dx, double dy) {
    Polygon region;
    for (int k = 0; k < b.n; ++k) region.push_back(b.arm(k) + Vec2(dx, dy));
    for (int k = 0; k < a.n && region.size() > 2; ++k) region = clip(region, a.normal(k).x(), a.normal(k).y(), a.offset[k]);
    if (region.size() < 3) return 0.0;
    return 0.5 * (potential(region, a, 0.0, 0.0) + potential(region, b, dx, dy));
}

}  // namespace talus
