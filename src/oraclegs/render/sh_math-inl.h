// Real spherical harmonics to degree 3 and their gradient (docs/method.md#spherical-harmonics). F as in
// splat_math-inl.h.

#if defined(ORACLEGS_RENDER_SH_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_RENDER_SH_MATH_INL_H_
#undef ORACLEGS_RENDER_SH_MATH_INL_H_
#else
#define ORACLEGS_RENDER_SH_MATH_INL_H_
#endif

#include "oraclegs/core/device_macros.h"
#include "oraclegs/core/simd/scalar_ops-inl.h"

#if !defined(__CUDACC__)
#include <hwy/highway.h>
HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {
#else
namespace oraclegs::cuda {
#endif

template <class F>
struct Vec3 {
  F x, y, z;
};

template <class F>
ORACLEGS_HD inline F Dot(const Vec3<F>& a, const Vec3<F>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// basis[k] for k < (degree+1)^2 at the unit direction d.
template <class F>
ORACLEGS_HD inline void ShBasis(int degree, const Vec3<F>& d, F* basis) {
  basis[0] = F(0.28209479177387814);
  if (degree < 1) return;
  const F x = d.x, y = d.y, z = d.z;
  const F c1(0.4886025119029199);
  basis[1] = -c1 * y;
  basis[2] = c1 * z;
  basis[3] = -c1 * x;
  if (degree < 2) return;
  const F xx = x * x, yy = y * y, zz = z * z, xy = x * y, yz = y * z, xz = x * z;
  basis[4] = F(1.0925484305920792) * xy;
  basis[5] = F(-1.0925484305920792) * yz;
  basis[6] = F(0.31539156525252005) * (F(2.f) * zz - xx - yy);
  basis[7] = F(-1.0925484305920792) * xz;
  basis[8] = F(0.5462742152960396) * (xx - yy);
  if (degree < 3) return;
  basis[9] = F(-0.5900435899266435) * y * (F(3.f) * xx - yy);
  basis[10] = F(2.890611442640554) * xy * z;
  basis[11] = F(-0.4570457994644658) * y * (F(4.f) * zz - xx - yy);
  basis[12] = F(0.3731763325901154) * z * (F(2.f) * zz - F(3.f) * xx - F(3.f) * yy);
  basis[13] = F(-0.4570457994644658) * x * (F(4.f) * zz - xx - yy);
  basis[14] = F(1.445305721320277) * z * (xx - yy);
  basis[15] = F(-0.5900435899266435) * x * (xx - F(3.f) * yy);
}

/// Sum over k >= 1 of weight[k] * gradient of basis[k] with x, y, z taken as independent.
template <class F>
ORACLEGS_HD inline Vec3<F> ShGradient(int degree, const Vec3<F>& d, const F* weight) {
  if (degree < 1) return {F(0.f), F(0.f), F(0.f)};
  const F x = d.x, y = d.y, z = d.z;
  const F c1(0.4886025119029199);
  Vec3<F> g{-c1 * weight[3], -c1 * weight[1], c1 * weight[2]};
  if (degree < 2) return g;
  const F a4 = F(1.0925484305920792) * weight[4], a5 = F(-1.0925484305920792) * weight[5];
  const F a6 = F(0.6307831305050401) * weight[6], a7 = F(-1.0925484305920792) * weight[7];
  const F a8 = F(1.0925484305920792) * weight[8];
  g.x = g.x + a4 * y - a6 * x + a7 * z + a8 * x;
  g.y = g.y + a4 * x + a5 * z - a6 * y - a8 * y;
  g.z = g.z + a5 * y + F(2.f) * a6 * z + a7 * x;
  if (degree < 3) return g;
  const F xx = x * x, yy = y * y, zz = z * z, xy = x * y, yz = y * z, xz = x * z;
  const F three(3.f), six(6.f), four(4.f), two(2.f), eight(8.f);
  const F b0 = F(-0.5900435899266435) * weight[9], b1 = F(2.890611442640554) * weight[10];
  const F b2 = F(-0.4570457994644658) * weight[11], b3 = F(0.3731763325901154) * weight[12];
  const F b4 = F(-0.4570457994644658) * weight[13], b5 = F(1.445305721320277) * weight[14];
  const F b6 = F(-0.5900435899266435) * weight[15];
  g.x = g.x + b0 * six * xy + b1 * yz - b2 * two * xy - b3 * six * xz + b4 * (four * zz - three * xx - yy) +
        b5 * two * xz + b6 * three * (xx - yy);
  g.y = g.y + b0 * three * (xx - yy) + b1 * xz + b2 * (four * zz - xx - three * yy) - b3 * six * yz - b4 * two * xy -
        b5 * two * yz - b6 * six * xy;
  g.z = g.z + b1 * xy + b2 * eight * yz + b3 * (six * zz - three * xx - three * yy) + b4 * eight * xz + b5 * (xx - yy);
  return g;
}

}  // namespace
#if !defined(__CUDACC__)
HWY_AFTER_NAMESPACE();
#endif
#endif
