// The mathematics of one Gaussian: projection, color, and their derivatives (docs/method.md#gaussian-parameters to
// #color-gradient).
//
// One body of code for all devices. F is the number type: float or double on the host and in CUDA threads, a SIMD
// vector in cpu/project.cpp. It needs + - * /, unary -, construction from float, comparisons that give a mask type, and
// the functions Select(mask, a, b), And(mask, mask), Min, Max, Sqrt, Exp. Nothing here branches on data.
//
// Highway includes this file once per instruction set, hence the unusual guard (Highway's own idiom for "-inl.h").

#if defined(ORACLEGS_RENDER_SPLAT_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_RENDER_SPLAT_MATH_INL_H_
#undef ORACLEGS_RENDER_SPLAT_MATH_INL_H_
#else
#define ORACLEGS_RENDER_SPLAT_MATH_INL_H_
#endif

#include "oraclegs/core/device_macros.h"
#include "oraclegs/render/constants.h"
#include "oraclegs/render/sh_math-inl.h"
#include "oraclegs/render/splat_camera.h"

#if !defined(__CUDACC__)
#include <hwy/highway.h>
HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {
#else
namespace oraclegs::cuda {
#endif

/// Raw parameters of one Gaussian without SH.
template <class F>
struct RawSplat {
  Vec3<F> mean, log_scale;
  F qw, qx, qy, qz, logit;
};

/// A Gaussian as the rasterizer takes it, and intermediate values that its derivative reads again.
template <class F>
struct ProjectedSplat {
  F mx, my;                     ///< projected center, px
  F z;                          ///< camera depth
  F conic_a, conic_b, conic_c;  ///< inverse covariance, 1/px^2
  F cov_a, cov_c;               ///< diagonal of the dilated covariance, px^2
  F opacity;                    ///< effective
};

/// The chain from raw parameters to the 2-D covariance, kept for the derivative.
template <class F>
struct SplatChain {
  Vec3<F> cam;     ///< camera-space center
  F u, v, cu, cv;  ///< x/z, y/z and their clamped values
  Vec3<F> scale;
  F qw, qx, qy, qz, inv_norm;
  F w[9];          ///< R_w R(q)
  F m[9];          ///< w times the scales, column by column
  F n0[3], n1[3];  ///< rows of J m: the square root of the covariance
  F a0, b, c0, det0, a, c, det;
  F opacity, compensation, ratio;
};

/// exp of arguments clamped to the range of vectorized exponentials, about 88. Models of other trainers may exceed it;
/// the result is the same in float.
template <class F>
ORACLEGS_HD inline F BoundedExp(F x) {
  return Exp(Min(Max(x, F(-80.f)), F(80.f)));
}

template <class F>
ORACLEGS_HD inline F Sigmoid(F x) {
  return F(1.f) / (F(1.f) + BoundedExp(-x));
}

template <class F, class T>
ORACLEGS_HD inline SplatChain<F> EvaluateChain(const RawSplat<F>& raw, const SplatCamera<T>& camera) {
  SplatChain<F> c;
  const Vec3<F>& p = raw.mean;
  c.cam.x = F(camera.r[0]) * p.x + F(camera.r[1]) * p.y + F(camera.r[2]) * p.z + F(camera.t[0]);
  c.cam.y = F(camera.r[3]) * p.x + F(camera.r[4]) * p.y + F(camera.r[5]) * p.z + F(camera.t[1]);
  c.cam.z = F(camera.r[6]) * p.x + F(camera.r[7]) * p.y + F(camera.r[8]) * p.z + F(camera.t[2]);
  const F inv_z = F(1.f) / c.cam.z;
  c.u = c.cam.x * inv_z;
  c.v = c.cam.y * inv_z;
  c.cu = Min(Max(c.u, F(camera.min_u)), F(camera.max_u));
  c.cv = Min(Max(c.v, F(camera.min_v)), F(camera.max_v));

  c.scale = {BoundedExp(raw.log_scale.x), BoundedExp(raw.log_scale.y), BoundedExp(raw.log_scale.z)};
  c.inv_norm = F(1.f) / Sqrt(raw.qw * raw.qw + raw.qx * raw.qx + raw.qy * raw.qy + raw.qz * raw.qz);
  c.qw = raw.qw * c.inv_norm;
  c.qx = raw.qx * c.inv_norm;
  c.qy = raw.qy * c.inv_norm;
  c.qz = raw.qz * c.inv_norm;
  const F one(1.f), two(2.f);
  const F q[9] = {one - two * (c.qy * c.qy + c.qz * c.qz), two * (c.qx * c.qy - c.qw * c.qz),
                  two * (c.qx * c.qz + c.qw * c.qy),       two * (c.qx * c.qy + c.qw * c.qz),
                  one - two * (c.qx * c.qx + c.qz * c.qz), two * (c.qy * c.qz - c.qw * c.qx),
                  two * (c.qx * c.qz - c.qw * c.qy),       two * (c.qy * c.qz + c.qw * c.qx),
                  one - two * (c.qx * c.qx + c.qy * c.qy)};
  const F s[3] = {c.scale.x, c.scale.y, c.scale.z};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      c.w[3 * i + j] =
          F(camera.r[3 * i]) * q[j] + F(camera.r[3 * i + 1]) * q[3 + j] + F(camera.r[3 * i + 2]) * q[6 + j];
      c.m[3 * i + j] = c.w[3 * i + j] * s[j];
    }
  }
  const F jx = F(camera.fx) * inv_z, jy = F(camera.fy) * inv_z;
  for (int j = 0; j < 3; ++j) {
    c.n0[j] = jx * (c.m[j] - c.cu * c.m[6 + j]);
    c.n1[j] = jy * (c.m[3 + j] - c.cv * c.m[6 + j]);
  }
  // Cauchy-Binet keeps the determinant of needles free of cancellation (docs/method.md#projection).
  const F k0 = c.n0[1] * c.n1[2] - c.n0[2] * c.n1[1];
  const F k1 = c.n0[2] * c.n1[0] - c.n0[0] * c.n1[2];
  const F k2 = c.n0[0] * c.n1[1] - c.n0[1] * c.n1[0];
  c.a0 = c.n0[0] * c.n0[0] + c.n0[1] * c.n0[1] + c.n0[2] * c.n0[2];
  c.c0 = c.n1[0] * c.n1[0] + c.n1[1] * c.n1[1] + c.n1[2] * c.n1[2];
  c.b = c.n0[0] * c.n1[0] + c.n0[1] * c.n1[1] + c.n0[2] * c.n1[2];
  c.det0 = k0 * k0 + k1 * k1 + k2 * k2;
  const F low(kLowPass);
  c.a = c.a0 + low;
  c.c = c.c0 + low;
  c.det = c.det0 + low * (c.a0 + c.c0) + low * low;
  c.opacity = Sigmoid(raw.logit);
  c.ratio = c.det0 / c.det;
  c.compensation = camera.antialiased ? Sqrt(Max(c.ratio, F(kCompensationFloor))) : F(1.f);
  return c;
}

/// Projects (docs/method.md#projection). Values are meaningless where z <= kNearPlane.
template <class F, class T>
ORACLEGS_HD inline ProjectedSplat<F> Project(const SplatChain<F>& c, const SplatCamera<T>& camera) {
  const F inv_det = F(1.f) / c.det;
  return {F(camera.fx) * c.u + F(camera.cx),
          F(camera.fy) * c.v + F(camera.cy),
          c.cam.z,
          c.c * inv_det,
          -c.b * inv_det,
          c.a * inv_det,
          c.a,
          c.c,
          c.opacity * c.compensation};
}

/// dL/d(projected quantities) of one Gaussian, summed over pixels.
template <class F>
struct ProjectedGrad {
  F mx, my, conic_a, conic_b, conic_c, opacity, inv_z;
};

/// dL/d(quantities of the camera's frame): what moves with the Gaussian and with the camera alike.
template <class F>
struct CameraSpaceGrad {
  Vec3<F> cam;  ///< the center, through the Jacobian too
  F j[6];       ///< the Jacobian, row-major; j[1] and j[3] matter to the camera's rotation alone
  F m[9];       ///< SplatChain::m, row-major
  F logit;
};

template <class F>
struct RawGrad {
  Vec3<F> mean, log_scale;
  F qw, qx, qy, qz, logit;
};

/// The adjoint of EvaluateChain and Project down to the camera's frame (docs/method.md#gaussian-gradient). With N = J m
/// the covariance is N N', so d/dN = 2 G N and the world covariance never appears.
template <class F, class T>
ORACLEGS_HD inline CameraSpaceGrad<F> ProjectBackward(const SplatChain<F>& c, const SplatCamera<T>& camera,
                                                      const ProjectedGrad<F>& g) {
  const F zero(0.f), one(1.f), two(2.f), half(0.5f);
  // [g_a, g_b/2; g_b/2, g_c] = -K G_k K
  const F inv_det = one / c.det;
  const F ka = c.c * inv_det, kb = -c.b * inv_det, kc = c.a * inv_det;
  const F hb = half * g.conic_b;
  const F t00 = ka * g.conic_a + kb * hb, t01 = ka * hb + kb * g.conic_c;
  const F t10 = kb * g.conic_a + kc * hb, t11 = kb * hb + kc * g.conic_c;
  F ga = -(t00 * ka + t01 * kb), gb = F(-2.f) * (t00 * kb + t01 * kc), gc = -(t10 * kb + t11 * kc);
  F g_opacity = g.opacity;
  if (camera.antialiased) {
    g_opacity = c.compensation * g.opacity;
    const F g_ratio = Select(c.ratio > F(kCompensationFloor), c.opacity * g.opacity / (two * c.compensation), zero);
    const F k = g_ratio * F(kLowPass) * inv_det * inv_det;
    ga = ga + k * (c.c0 * c.c0 + F(kLowPass) * c.c0 + c.b * c.b);
    gc = gc + k * (c.a0 * c.a0 + F(kLowPass) * c.a0 + c.b * c.b);
    gb = gb - two * k * c.b * (c.a0 + c.c0 + F(kLowPass));
  }

  CameraSpaceGrad<F> out;
  out.logit = g_opacity * c.opacity * (one - c.opacity);

  F gn0[3], gn1[3];
  for (int j = 0; j < 3; ++j) {
    gn0[j] = two * ga * c.n0[j] + gb * c.n1[j];
    gn1[j] = gb * c.n0[j] + two * gc * c.n1[j];
  }
  const F inv_z = one / c.cam.z;
  const F jx = F(camera.fx) * inv_z, jy = F(camera.fy) * inv_z;
  // g_J = g_N m'
  for (F& entry : out.j) entry = zero;
  for (int j = 0; j < 3; ++j) {
    for (int k = 0; k < 3; ++k) {
      out.j[k] = out.j[k] + gn0[j] * c.m[3 * k + j];
      out.j[3 + k] = out.j[3 + k] + gn1[j] * c.m[3 * k + j];
    }
    out.m[j] = jx * gn0[j];  // J' g_N
    out.m[3 + j] = jy * gn1[j];
    out.m[6 + j] = -(jx * c.cu * gn0[j] + jy * c.cv * gn1[j]);
  }

  // Camera-space center. Where u is clamped the third column of J does not depend on x.
  const auto u_free = And(c.u >= F(camera.min_u), c.u <= F(camera.max_u));
  const auto v_free = And(c.v >= F(camera.min_v), c.v <= F(camera.max_v));
  const F sx = jx * inv_z * out.j[2], sy = jy * inv_z * out.j[5];
  out.cam.x = g.mx * jx - Select(u_free, sx, zero);
  out.cam.y = g.my * jy - Select(v_free, sy, zero);
  out.cam.z = -inv_z * (g.mx * F(camera.fx) * c.u + g.my * F(camera.fy) * c.v) - g.inv_z * inv_z * inv_z -
              inv_z * inv_z * (F(camera.fx) * out.j[0] + F(camera.fy) * out.j[4]) +
              Select(u_free, two, one) * c.cu * sx + Select(v_free, two, one) * c.cv * sy;
  return out;
}

/// From the camera's frame to the raw parameters. The caller adds the color's part of d/d(mean).
template <class F, class T>
ORACLEGS_HD inline RawGrad<F> RawBackward(const SplatChain<F>& c, const SplatCamera<T>& camera,
                                          const CameraSpaceGrad<F>& g) {
  const F two(2.f);
  RawGrad<F> out;
  out.logit = g.logit;
  out.mean = {F(camera.r[0]) * g.cam.x + F(camera.r[3]) * g.cam.y + F(camera.r[6]) * g.cam.z,
              F(camera.r[1]) * g.cam.x + F(camera.r[4]) * g.cam.y + F(camera.r[7]) * g.cam.z,
              F(camera.r[2]) * g.cam.x + F(camera.r[5]) * g.cam.y + F(camera.r[8]) * g.cam.z};

  // Scales, and E = d/dR(q) = R_w' g_m S.
  const F s[3] = {c.scale.x, c.scale.y, c.scale.z};
  F gs[3], e[9];
  for (int j = 0; j < 3; ++j) {
    gs[j] = s[j] * (c.w[j] * g.m[j] + c.w[3 + j] * g.m[3 + j] + c.w[6 + j] * g.m[6 + j]);
    for (int i = 0; i < 3; ++i) {
      e[3 * i + j] =
          s[j] * (F(camera.r[i]) * g.m[j] + F(camera.r[3 + i]) * g.m[3 + j] + F(camera.r[6 + i]) * g.m[6 + j]);
    }
  }
  out.log_scale = {gs[0], gs[1], gs[2]};
  const F w = c.qw, x = c.qx, y = c.qy, z = c.qz;
  const F hw = two * (z * (e[3] - e[1]) + y * (e[2] - e[6]) + x * (e[7] - e[5]));
  const F hx = two * (y * (e[1] + e[3]) + z * (e[2] + e[6]) + w * (e[7] - e[5]) - two * x * (e[4] + e[8]));
  const F hy = two * (x * (e[1] + e[3]) + z * (e[5] + e[7]) + w * (e[2] - e[6]) - two * y * (e[0] + e[8]));
  const F hz = two * (x * (e[2] + e[6]) + y * (e[5] + e[7]) + w * (e[3] - e[1]) - two * z * (e[0] + e[4]));
  const F radial = w * hw + x * hx + y * hy + z * hz;
  out.qw = (hw - w * radial) * c.inv_norm;
  out.qx = (hx - x * radial) * c.inv_norm;
  out.qy = (hy - y * radial) * c.inv_norm;
  out.qz = (hz - z * radial) * c.inv_norm;
  return out;
}

/// One Gaussian's terms of the sums of kCameraSums.
template <class F>
struct CameraTerms {
  F of[kCameraSums];
};

/// dL/d(camera) through one Gaussian (docs/method.md#camera-gradient). `mean`: dL/d(mean), the
/// color's part included. That part is none of the rotation's: viewing directions begin at the camera's center, about
/// which it turns.
template <class F, class T>
ORACLEGS_HD inline CameraTerms<F> CameraBackward(const SplatChain<F>& c, const SplatCamera<T>& camera,
                                                 const ProjectedGrad<F>& g, const CameraSpaceGrad<F>& s,
                                                 const Vec3<F>& mean) {
  CameraTerms<F> out;
  F* const terms = out.of;
  terms[0] = mean.x, terms[1] = mean.y, terms[2] = mean.z;
  // The center's part p x g_p; m's, which turns with it, is the antisymmetric part of J' g_J.
  const F zero(0.f), inv_z = F(1.f) / c.cam.z;
  const F jx = F(camera.fx) * inv_z, jy = F(camera.fy) * inv_z, jz0 = -jx * c.cu, jz1 = -jy * c.cv;
  terms[3] = c.cam.y * s.cam.z - c.cam.z * s.cam.y + jz0 * s.j[1] + jz1 * s.j[4] - jy * s.j[5];
  terms[4] = c.cam.z * s.cam.x - c.cam.x * s.cam.z + jx * s.j[2] - jz0 * s.j[0] - jz1 * s.j[3];
  terms[5] = c.cam.x * s.cam.y - c.cam.y * s.cam.x + jy * s.j[3] - jx * s.j[1];
  // Where u is clamped, fx times it is the image's border minus cx, whatever fx is.
  const auto u_free = And(c.u >= F(camera.min_u), c.u <= F(camera.max_u));
  const auto v_free = And(c.v >= F(camera.min_v), c.v <= F(camera.max_v));
  terms[6] = g.mx * c.u + inv_z * (s.j[0] - Select(u_free, c.cu * s.j[2], zero));
  terms[7] = g.my * c.v + inv_z * (s.j[4] - Select(v_free, c.cv * s.j[5], zero));
  terms[8] = g.mx + Select(u_free, zero, inv_z * s.j[2]);
  terms[9] = g.my + Select(v_free, zero, inv_z * s.j[5]);
  return out;
}

}  // namespace
#if !defined(__CUDACC__)
HWY_AFTER_NAMESPACE();
#endif
#endif
