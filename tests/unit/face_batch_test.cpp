#include "contact/face_batch.hpp"
#include "core/random.hpp"
#include "support/catch.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

using namespace talus;

namespace {

/// Two faces of about 1 m that nearly lie on each other, with joints, memories and velocities of all kinds.
void fill(FaceBatch& q, FaceColumns& known, Random& random) {
    for (int i = 0; i < FaceBatch::size; ++i) {
        const auto around = [&](double middle, double by) { return middle + by * (2.0 * random.uniform() - 1.0); };
        const auto flag = [&] { return random.uniform() < 0.5 ? 0.0 : 1.0; };
        const double turn = around(0.0, 0.12), up = 6.3 * random.uniform(), c = std::cos(up), s = std::sin(up);
        const auto put = [&](double x, double y, double& px, double& py) { px = c * x - s * y, py = s * x + c * y; };
        put(around(0.5, 0.1), 0.4, q.a0x[i], q.a0y[i]);
        put(around(-0.5, 0.1), 0.4, q.a1x[i], q.a1y[i]);
        put(0.0, 1.0, q.nax[i], q.nay[i]);
        const double half = around(0.5, 0.1), ct = std::cos(turn), st = std::sin(turn);
        put(half * ct + 0.4 * st, half * st - 0.4 * ct, q.b0x[i], q.b0y[i]);
        put(-half * ct + 0.4 * st, -half * st - 0.4 * ct, q.b1x[i], q.b1y[i]);
        put(st, -ct, q.nbx[i], q.nby[i]);
        put(around(0.0, 1.0), 0.8 + around(-1e-3, 3e-3), q.dx[i], q.dy[i]);
        q.a_lo[i] = flag(), q.a_hi[i] = flag(), q.b_lo[i] = flag(), q.b_hi[i] = flag();
        known.s0[i] = around(0.1, 0.1);
        known.s1[i] = flag() == 0.0 ? std::numeric_limits<double>::infinity() : around(0.8, 0.1);
        known.sigma0[i] = flag() * around(0.0, 1e6), known.sigma1[i] = flag() * around(0.0, 1e6);
        q.vax[i] = around(0, 1), q.vay[i] = around(0, 1), q.spin_a[i] = around(0, 1);
        q.vbx[i] = around(0, 1), q.vby[i] = around(0, 1), q.spin_b[i] = around(0, 1);
        q.kn[i] = 1e9, q.ks[i] = 5e8, q.tan_friction[i] = around(0.5, 0.2), q.tan_friction_residual[i] = 0.2;
        q.cohesion_residual[i] = flag() * 1e4, q.weakens[i] = flag(), q.tan_dilation[i] = flag() * 0.1;
        q.dilation_cutoff_slip[i] = 1e-3;
        known.force[i] = around(0.0, 1e6), known.energy[i] = std::abs(around(0.0, 3e3)), known.slip[i] = random.uniform();
        known.slip_sum[i] = around(0.0, 2e-3), known.dilation[i] = flag() * 1e-4, known.slipped[i] = flag();
        put(around(0.0, 0.1), 1.0, known.nx[i], known.ny[i]);
    }
}

using Columns = ContactColumns;
constexpr Columns::Row Columns::*columns[] = {
    &Columns::force,   &Columns::energy,       &Columns::slip,     &Columns::slip_sum, &Columns::dilation,
    &Columns::slipped, &Columns::nx,           &Columns::ny,       &Columns::sliding,  &Columns::length,
    &Columns::overlap, &Columns::normal_force, &Columns::strength, &Columns::x,        &Columns::y};

}  // namespace

TEST_CASE("a batch of faces gives the same bits with every kind of vector register") {
    Random random(11);
    int loaded = 0, sliding = 0, invalid = 0, kinds = 0;
    for (int trial = 0; trial < 200; ++trial) {
        FaceBatch given{};
        given.count = FaceBatch::size;
        FaceColumns known{};
        fill(given, known, random);
        FaceBatch plain = given;
        FaceColumns after = known;
        face_kernel(VectorUnit::baseline)(plain, after, 1e-4, 1e-4);
        for (int i = 0; i < FaceBatch::size; ++i) {
            const bool counts = plain.valid[i] != 0.0 && plain.loaded[i] != 0.0;
            loaded += counts;
            sliding += counts && after.sliding[i] != 0.0;
            invalid += plain.valid[i] == 0.0;
            for (const auto row : columns)
                if (!counts) CHECK(std::memcmp(&(after.*row)[i], &(known.*row)[i], sizeof(double)) == 0);
        }
        for (const VectorUnit unit : {VectorUnit::avx2, VectorUnit::avx512}) {
            if (!has(unit)) continue;
            ++kinds;
            FaceBatch other = given;
            FaceColumns here = known;
            face_kernel(unit)(other, here, 1e-4, 1e-4);
            int differences = 0;
            for (int i = 0; i < FaceBatch::size; ++i) {
                CHECK(other.valid[i] == plain.valid[i]);
                if (plain.valid[i] == 0.0) continue;
                CHECK(other.loaded[i] == plain.loaded[i]);
                if (plain.loaded[i] == 0.0) continue;
                for (const auto row : columns)
                    differences += std::memcmp(&(here.*row)[i], &(after.*row)[i], sizeof(double)) != 0;
                for (const auto row : {&FaceBatch::fx, &FaceBatch::fy, &FaceBatch::torque_a, &FaceBatch::torque_b,
                                       &FaceBatch::friction, &FaceBatch::damping, &FaceBatch::released})
                    differences += std::memcmp(&(other.*row)[i], &(plain.*row)[i], sizeof(double)) != 0;
            }
            CHECK(differences == 0);
        }
    }
    CHECK(loaded > 500);
    CHECK(sliding > 100);
    CHECK(invalid > 100);
    if (has(VectorUnit::avx2)) CHECK(kinds > 0);
}
