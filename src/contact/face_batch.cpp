#include "contact/face_batch.hpp"

#include <limits>

namespace talus {
namespace {

[[gnu::always_inline]] inline void one_face(FaceBatch& q, FaceColumns& kept, int i, double dt, double damping) {
    FaceLines f;
    f.a0x = q.a0x[i], f.a0y = q.a0y[i], f.a1x = q.a1x[i], f.a1y = q.a1y[i], f.nax = q.nax[i], f.nay = q.nay[i];
    f.b0x = q.b0x[i], f.b0y = q.b0y[i], f.b1x = q.b1x[i], f.b1y = q.b1y[i], f.nbx = q.nbx[i], f.nby = q.nby[i];
    f.a_lo = q.a_lo[i], f.a_hi = q.a_hi[i], f.b_lo = q.b_lo[i], f.b_hi = q.b_hi[i];
    const Vector thicker = talus::thicker(kept, i);
    f.dx = q.dx[i] - thicker.x, f.dy = q.dy[i] - thicker.y;

    const JointLaw joint = q.law(i);
    const Window w = face_window(f);
    const double softness = 1.0 / joint.kn;
    const Closure closure = closure_of(w, {kept.s0[i], kept.s1[i], kept.sigma0[i] * softness, kept.sigma1[i] * softness});
    const bool remembers = kept.s1[i] < std::numeric_limits<double>::infinity();
    FaceIntegral sum;
    sum.positive(w.lo, w.hi, closure.lo, closure.hi);
    const Pressed p = pressed_face(f, w, closure, sum, 0.0, false, false);
    const bool valid = w.valid & (w.simple | remembers);
    const bool loaded = (std::max(closure.lo, closure.hi) > 0.0) & (sum.length > 0.0);
    q.respond_to(i, kept, valid & loaded, p, joint, thicker, remembers ? kept.s1[i] - kept.s0[i] : 0.0, dt, damping);
    q.valid[i] = valid ? 1.0 : 0.0;
    q.loaded[i] = loaded ? 1.0 : 0.0;
}

[[gnu::always_inline]] inline void all_faces(FaceBatch& q, FaceColumns& kept, double dt, double damping) {
    for (int first = 0; first < q.count; first += FaceBatch::group)
#pragma GCC ivdep
        for (int i = first; i < first + FaceBatch::group; ++i) one_face(q, kept, i, dt, damping);
}

void baseline(FaceBatch& batch, FaceColumns& columns, double dt, double damping) { all_faces(batch, columns, dt, damping); }

#ifdef TALUS_VECTOR_UNITS
TALUS_AVX2 void avx2(FaceBatch& batch, FaceColumns& columns, double dt, double damping) {
    all_faces(batch, columns, dt, damping);
}
TALUS_AVX512 void avx512(FaceBatch& batch, FaceColumns& columns, double dt, double damping) {
    all_faces(batch, columns, dt, damping);
}
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
