#include "rigid/touch_arms.hpp"

#include "core/turn.hpp"

namespace talus::rigid {

void set_arms(const Manifold& m, const Vec2& from_a, const Bodies& bodies, const Ahead& ahead, Touch& c) {
    const Velocity& face = m.face_of_b ? ahead.b : ahead.a;
    const Vec2 n = turned(m.normal, ahead.time * face.spin);
    c.nx = n.x(), c.ny = n.y();
    const Vec2 to_b = bodies.position[c.b] - bodies.position[c.a];
    const Vec2 apart = to_b + ahead.time * Vec2(ahead.b.x - ahead.a.x, ahead.b.y - ahead.a.y);
    for (int end = 0; end < m.count; ++end) {
        Vec2 arm = m.point[end] + from_a;  // from a
        if (ahead.time != 0.0) {           // the corner moves with its body, and comes onto the face
            const bool of_b = m.corner_of_b[end];
            const Turn own = turn(ahead.time * (of_b ? ahead.b.spin : ahead.a.spin));
            const Vec2 corner = arm + (of_b ? 0.5 : -0.5) * m.gap[end] * m.normal - (of_b ? to_b : Vec2(Vec2::Zero()));
            arm = turned(corner, own) + (of_b ? apart : Vec2(Vec2::Zero()));
        }
        c.arm_a[end] = cross(arm, n);
        c.arm_b[end] = cross(arm - apart, n);
        if (end != nearest(m)) continue;
        c.arm_a[2] = cross(arm, perp(n));
        c.arm_b[2] = cross(arm - apart, perp(n));
    }
    prepare(c, bodies.softness);
}

Vec2 bend(const Manifold& m, const Bodies& bodies, std::span<const Velocity> v, const Vec2& from_a, const Touch& c,
          int end) {
    const Velocity &a = v[c.a], &b = v[c.b];
    if (a.spin == 0.0 && b.spin == 0.0) return Vec2::Zero();
    const Vec2 arm_a = m.point[end] + from_a, arm_b = arm_a - (bodies.position[c.b] - bodies.position[c.a]);
    const Vec2 inward = a.spin * a.spin * arm_a - b.spin * b.spin * arm_b;
    const Vec2 slip = Vec2(b.x - a.x, b.y - a.y) + b.spin * perp(arm_b) - a.spin * perp(arm_a);
    const Vec2 n = m.normal, t = perp(n);
    const double face = 2.0 * (m.face_of_b ? b.spin : a.spin);
    return {n.dot(inward) + face * t.dot(slip), t.dot(inward) - face * n.dot(slip)};
}

}  // namespace talus::rigid
