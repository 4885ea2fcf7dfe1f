#include "contact/face_batch.hpp"

namespace talus {
namespace {

[[gnu::always_inline]] inline void all_faces(FaceBatch& q, double dt, double damping) {
#pragma GCC ivdep
    for (int i = 0; i < FaceBatch::size; ++i) {
        FaceLines f;
        f.a0x = q.a0x[i], f.a0y = q.a0y[i], f.a1x = q.a1x[i], f.a1y = q.a1y[i], f.nax = q.nax[i], f.nay = q.nay[i];
        f.b0x = q.b0x[i], f.b0y = q.b0y[i], f.b1x = q.b1x[i], f.b1y = q.b1y[i], f.nbx = q.nbx[i], f.nby = q.nby[i];
        f.a_lo = q.a_lo[i], f.a_hi = q.a_hi[i], f.b_lo = q.b_lo[i], f.b_hi = q.b_hi[i];
        const Vector thicker = q.thicker(i);
        f.dx = q.dx[i] - thicker.x, f.dy = q.dy[i] - thicker.y;

        const JointLaw joint = q.law(i);
        const Window w = face_window(f);
        const double softness = 1.0 / joint.kn;
        const Closure closure = closure_of(w, {q.s0[i], q.s1[i], q.sigma0[i] * softness, q.sigma1[i] * softness});
        FaceIntegral sum;
        sum.positive(w.lo, w.hi, closure.lo, closure.hi);
        const Pressed p = pressed_face(f, w, closure, sum, 0.0, false, false);
        q.respond_to(i, p, joint, thicker, dt, damping);
        q.valid[i] = w.valid & (w.simple | (q.remembers[i] != 0.0)) ? 1.0 : 0.0;
        q.loaded[i] = (std::max(closure.lo, closure.hi) > 0.0) & (sum.length > 0.0) ? 1.0 : 0.0;
    }
}

void baseline(FaceBatch& batch, double dt, double damping) { all_faces(batch, dt, damping); }

#ifdef TALUS_VECTOR_UNITS
TALUS_AVX2 void avx2(FaceBatch& batch, double dt, double damping) { all_faces(batch, dt, damping); }
TALUS_AVX512 void avx512(FaceBatch& batch, double dt, double damping) { all_faces(batch, dt, damping); }
#endif

}  // namespace

FaceKernel face_kernel([[maybe_unused]] VectorUnit unit) {
#ifdef TALUS_VECTOR_UNITS
    if (unit == VectorUnit::avx512) return avx512;
    if (unit == VectorUnit::avx2) return avx2;
#endif
    return baseline;
}

}  // namespace talus
