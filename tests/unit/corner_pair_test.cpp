#include "contact/corner_batch.hpp"
#include "contact/distance_potential.hpp"
#include "contact/face_path.hpp"
#include "core/random.hpp"
#include "dynamics/motion.hpp"
#include "geometry/polygon.hpp"
#include "model/build.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

#include <cmath>
#include <cstring>
#include <numbers>

using namespace talus;
using namespace talus::scenes;

namespace {

Vec2 along(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// First corner at the origin: a wedge that opens by `opening` about the direction `towards`.
Polygon wedge(double towards, double opening) {
    return {Vec2::Zero(), along(towards - opening / 2), 1.6 * along(towards), along(towards + opening / 2)};
}

/// Two blocks of which the first corner of b lies at `at` from the first corner of a.
class TwoCorners {
public:
    TwoCorners(const Polygon& a, const Polygon& b, const Vec2& at)
        : scene_(build(with({block("a", a), block("b", shifted(b, {100.0, 0.0}))}))),
          distance_(at + centroid(b) - centroid(a)) {
        scene_.state.motion.position[1] = scene_.state.motion.position[0] + distance_;
        place(scene_.model, all_awake(2), scene_.state.motion, 0.0, placed_);
        const PlacedPart pa = part(0), pb = part(1);
        const int i = nearest(pa, -centroid(a)), j = nearest(pb, -centroid(b));
        const Vec2 &a1 = pa.normal(pa.previous(i)), &a2 = pa.normal(i), &b1 = pb.normal(pb.previous(j)), &b2 = pb.normal(j);
        lines = {pa.arm(i).x(), pa.arm(i).y(), a1.x(), a1.y(), a2.x(),        a2.y(),        pb.arm(j).x(), pb.arm(j).y(),
                 b1.x(),        b1.y(),        b2.x(), b2.y(), distance_.x(), distance_.y(), 0.2,           1e-12};
    }
    Pressed general() const { return distance_potential(part(0), part(1), distance_.x(), distance_.y()); }
    bool any_face() const {
        for (int ea = 0; ea < part(0).n; ++ea)
            for (int eb = 0; eb < part(1).n; ++eb)
                if (face_contact(part(0), part(1), distance_.x(), distance_.y(), ea, eb, nullptr).state == FaceState::loaded)
                    return true;
        return false;
    }

    CornerLines lines;

private:
    PlacedPart part(int i) const { return {scene_.model, placed_, i}; }
    static int nearest(const PlacedPart& p, const Vec2& arm) {
        int best = 0;
        for (int k = 1; k < p.n; ++k)
            if ((p.arm(k) - arm).norm() < (p.arm(best) - arm).norm()) best = k;
        return best;
    }

    Scene scene_;
    Placed placed_;
    Vec2 distance_;
};

}  // namespace

TEST_CASE("two corners in each other carry what the general distance potential says") {
    Random random(23);
    int valid = 0, invalid = 0;
    for (int trial = 0; trial < 600; ++trial) {
        const auto between = [&](double lo, double hi) { return lo + (hi - lo) * random.uniform(); };
        const double towards = between(0.0, 2.0 * std::numbers::pi), depth = std::pow(10.0, between(-6.0, -1.5));
        const Polygon a = wedge(towards, between(0.6, 2.6));
        const Polygon b = wedge(towards + std::numbers::pi + between(-0.6, 0.6), between(0.6, 2.6));
        const TwoCorners pair(a, b, depth * along(towards + between(-1.5, 1.5)));
        const CornerPair closed = corner_pair(pair.lines);
        ++(closed.valid ? valid : invalid);
        if (!closed.valid) continue;
        const Pressed p = closed.pressed, general = pair.general();
        const double force = 1e-9 * general.along_normal, length = 1e-8 * general.length;
        CHECK(p.fx == Approx(general.fx).margin(force));
        CHECK(p.fy == Approx(general.fy).margin(force));
        CHECK(p.along_normal == Approx(general.along_normal).margin(force));
        CHECK(p.torque_a == Approx(general.torque_a).margin(force));
        CHECK(p.torque_b == Approx(general.torque_b).margin(force));
        CHECK(p.length == Approx(general.length).margin(length));
        CHECK(p.overlap == Approx(general.overlap).margin(length));
        CHECK(p.x == Approx(general.x).margin(length));
        CHECK(p.y == Approx(general.y).margin(length));
        CHECK(p.nx == Approx(general.nx).margin(1e-8));
        CHECK(p.ny == Approx(general.ny).margin(1e-8));
    }
    CHECK(valid > 150);
    CHECK(invalid > 150);
}

TEST_CASE("corners are no pair where faces lie on each other, nor where the overlap reaches other edges") {
    const Polygon square{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, below{{0, 0}, {-1, 0}, {-1, -1}, {0, -1}};
    int faces = 0, pairs = 0;
    for (double ratio = 1.0; ratio < 40.0; ratio *= 1.02)
        for (const double turn : {0.0, 1e-5, -3e-4}) {
            Polygon turned;
            for (const Vec2& p : below) turned.push_back(p + turn * perp(p));
            const TwoCorners pair(square, turned, {1e-4 * ratio, 1e-4});
            const bool face = pair.any_face(), corners = corner_pair(pair.lines).valid;
            CHECK_FALSE((face && corners));
            faces += face, pairs += corners;
        }
    CHECK(faces > 50);
    CHECK(pairs > 200);

    TwoCorners deep(square, below, {0.3, 0.25});
    CHECK_FALSE(corner_pair(deep.lines).valid);  // beyond the reach
    TwoCorners outside(square, below, {0.3e-3, -1e-4});
    CHECK_FALSE(corner_pair(outside.lines).valid);
}

TEST_CASE("a batch of corners gives the same bits with every kind of vector register, and as one by one") {
    Random random(5);
    CornerBatch given{};
    given.count = CornerBatch::size;
    const auto around = [&](double middle, double by) { return middle + by * (2.0 * random.uniform() - 1.0); };
    for (int i = 0; i < CornerBatch::size; ++i) {
        const double towards = around(0.0, 3.0);
        const TwoCorners pair(wedge(towards, around(1.6, 0.5)), wedge(towards + std::numbers::pi, around(1.6, 0.5)),
                              1e-3 * along(towards + around(0.0, 1.0)));
        const CornerLines& l = pair.lines;
        given.ax[i] = l.ax, given.ay[i] = l.ay, given.na1x[i] = l.na1x, given.na1y[i] = l.na1y;
        given.na2x[i] = l.na2x, given.na2y[i] = l.na2y, given.bx[i] = l.bx, given.by[i] = l.by;
        given.nb1x[i] = l.nb1x, given.nb1y[i] = l.nb1y, given.nb2x[i] = l.nb2x, given.nb2y[i] = l.nb2y;
        given.dx[i] = l.dx, given.dy[i] = l.dy, given.reach[i] = l.reach, given.touch_depth[i] = l.touch_depth;
        given.kn[i] = 1e9, given.ks[i] = 5e8, given.tan_friction[i] = 0.6;
        given.vax[i] = around(0, 1), given.vby[i] = around(0, 1), given.spin_b[i] = around(0, 1);
        given.force[i] = around(0.0, 100.0), given.energy[i] = 1e-3, given.nx[i] = 1.0;
    }
    CornerBatch plain = given;
    corner_kernel(VectorUnit::baseline)(plain, 1e-4, 1e-4);
    int valid = 0;
    for (int i = 0; i < CornerBatch::size; ++i) {
        const CornerPair one =
            corner_pair({given.ax[i], given.ay[i], given.na1x[i], given.na1y[i], given.na2x[i], given.na2y[i], given.bx[i],
                         given.by[i], given.nb1x[i], given.nb1y[i], given.nb2x[i], given.nb2y[i], given.dx[i], given.dy[i],
                         given.reach[i], given.touch_depth[i]});
        CHECK(one.valid == (plain.valid[i] != 0.0));
        if (!one.valid) continue;
        ++valid;
        CHECK(one.pressed.x == plain.x[i]);
        CHECK(one.pressed.y == plain.y[i]);
        CHECK(one.pressed.nx == plain.nx[i]);
        CHECK(one.pressed.overlap == plain.overlap[i]);
    }
    CHECK(valid > 8);
    constexpr CornerBatch::Row CornerBatch::*rows[] = {
        &CornerBatch::force, &CornerBatch::energy, &CornerBatch::slip,     &CornerBatch::nx,
        &CornerBatch::fx,    &CornerBatch::fy,     &CornerBatch::torque_a, &CornerBatch::torque_b,
        &CornerBatch::x,     &CornerBatch::y,      &CornerBatch::friction, &CornerBatch::damping};
    for (const VectorUnit unit : {VectorUnit::avx2, VectorUnit::avx512}) {
        if (!has(unit)) continue;
        CornerBatch other = given;
        corner_kernel(unit)(other, 1e-4, 1e-4);
        for (int i = 0; i < CornerBatch::size; ++i) {
            CHECK(other.valid[i] == plain.valid[i]);
            if (plain.valid[i] == 0.0) continue;
            for (const auto row : rows) CHECK(std::memcmp(&(other.*row)[i], &(plain.*row)[i], sizeof(double)) == 0);
        }
    }
}
