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
        // Slip has thickened a joint that dilates: the same as moving b against a. The force acts at the true place, so that
        // torques still balance.
        const double thicker_x = q.dilation[i] * q.nx[i], thicker_y = q.dilation[i] * q.ny[i];
        f.dx = q.dx[i] - thicker_x, f.dy = q.dy[i] - thicker_y;

        JointLaw joint;
        joint.kn = q.kn[i], joint.ks = q.ks[i];
        joint.tan_friction = q.tan_friction[i], joint.tan_friction_residual = q.tan_friction_residual[i];
        joint.cohesion_residual = q.cohesion_residual[i], joint.weakens = q.weakens[i] != 0.0;
        joint.tan_dilation = q.tan_dilation[i], joint.dilation_cutoff_slip = q.dilation_cutoff_slip[i];

        const Window w = face_window(f);
        const double softness = 1.0 / joint.kn;
        const Closure closure = closure_of(w, {q.s0[i], q.s1[i], q.sigma0[i] * softness, q.sigma1[i] * softness});
        FaceIntegral sum;
        sum.positive(w.lo, w.hi, closure.lo, closure.hi);
        Pressed p = pressed_face(f, w, closure, sum, 0.0, false, false);
        p.torque_b -= thicker_x * p.fy - thicker_y * p.fx;

        ShearMemory shear;
        shear.force = q.force[i], shear.energy = q.energy[i], shear.slip = q.slip[i], shear.slip_sum = q.slip_sum[i];
        shear.dilation = q.dilation[i], shear.slipped = q.slipped[i];
        const Approach approach{q.vax[i], q.vay[i], q.spin_a[i], q.vbx[i], q.vby[i], q.spin_b[i], q.dx[i], q.dy[i]};
        const Response r = respond(joint, p, approach, dt, damping, q.face_length[i], Vector{q.nx[i], q.ny[i]}, shear);

        q.valid[i] = w.valid & (w.simple | (q.remembers[i] != 0.0)) ? 1.0 : 0.0;
        q.loaded[i] = (std::max(closure.lo, closure.hi) > 0.0) & (sum.length > 0.0) ? 1.0 : 0.0;
        q.force[i] = shear.force, q.energy[i] = shear.energy, q.slip[i] = shear.slip, q.slip_sum[i] = shear.slip_sum;
        q.dilation[i] = shear.dilation, q.slipped[i] = shear.slipped;
        q.sliding[i] = r.sliding ? 1.0 : 0.0;
        q.nx[i] = p.nx, q.ny[i] = p.ny, q.x[i] = p.x, q.y[i] = p.y, q.length[i] = p.length;
        q.overlap[i] = p.overlap, q.normal_force[i] = r.normal_force, q.strength[i] = r.strength;
        q.fx[i] = r.fx, q.fy[i] = r.fy, q.torque_a[i] = r.torque_a, q.torque_b[i] = r.torque_b;
        q.friction[i] = r.friction, q.damping[i] = r.damping, q.released[i] = r.released;
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
