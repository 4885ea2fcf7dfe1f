#include "contact/corner_batch.hpp"

namespace talus {
namespace {

[[gnu::always_inline]] inline void one_pair(CornerBatch& q, int i, double dt, double damping) {
    const Vector thicker = talus::thicker(q, i);
    CornerLines f;
    f.ax = q.ax[i], f.ay = q.ay[i], f.na1x = q.na1x[i], f.na1y = q.na1y[i], f.na2x = q.na2x[i], f.na2y = q.na2y[i];
    f.bx = q.bx[i], f.by = q.by[i], f.nb1x = q.nb1x[i], f.nb1y = q.nb1y[i], f.nb2x = q.nb2x[i], f.nb2y = q.nb2y[i];
    f.dx = q.dx[i] - thicker.x, f.dy = q.dy[i] - thicker.y;
    f.reach = q.reach[i], f.touch_depth = q.touch_depth[i];
    const CornerPair pair = corner_pair(f);
    q.respond_to(i, q, pair.valid, pair.pressed, q.law(i), thicker, 0.0, dt, damping);
    q.valid[i] = q.loaded[i] = pair.valid ? 1.0 : 0.0;
}

[[gnu::always_inline]] inline void all_corners(CornerBatch& q, double dt, double damping) {
    for (int first = 0; first < q.count; first += CornerBatch::group)
#pragma GCC ivdep
        for (int i = first; i < first + CornerBatch::group; ++i) one_pair(q, i, dt, damping);
}

void baseline(CornerBatch& batch, double dt, double damping) { all_corners(batch, dt, damping); }

#ifdef TALUS_VECTOR_UNITS
TALUS_AVX2 void avx2(CornerBatch& batch, double dt, double damping) { all_corners(batch, dt, damping); }
TALUS_AVX512 void avx512(CornerBatch& batch, double dt, double damping) { all_corners(batch, dt, damping); }
#endif

}  // namespace

CornerKernel corner_kernel([[maybe_unused]] VectorUnit unit) {
#ifdef TALUS_VECTOR_UNITS
    if (unit == VectorUnit::avx512) return avx512;
    if (unit == VectorUnit::avx2) return avx2;
#endif
    return baseline;
}

}  // namespace talus
