// Rounding of numbers and SIMD lanes: to whole numbers, and of a product with a sum.

#if defined(ORACLEGS_CORE_SIMD_ROUNDING_OPS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_CORE_SIMD_ROUNDING_OPS_INL_H_
#undef ORACLEGS_CORE_SIMD_ROUNDING_OPS_INL_H_
#else
#define ORACLEGS_CORE_SIMD_ROUNDING_OPS_INL_H_
#endif

#include <cmath>
#include <concepts>

#include "oraclegs/core/device_macros.h"

#if !defined(__CUDACC__)
#include "oraclegs/core/simd/lanes-inl.h"
HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {
#else
namespace oraclegs::cuda {
#endif

template <std::floating_point T>
ORACLEGS_HD inline T Ceil(T a) {
  return std::ceil(a);
}
template <std::floating_point T>
ORACLEGS_HD inline T Floor(T a) {
  return std::floor(a);
}
/// a b + c, rounded once, so that the compiler cannot choose another rounding in another kernel. SIMD lanes without
/// such an instruction round twice.
template <std::floating_point T>
ORACLEGS_HD inline T FusedMulAdd(T a, T b, T c) {
  return std::fma(a, b, c);
}

#if !defined(__CUDACC__)
HWY_INLINE Lanes Ceil(Lanes a) { return hn::Ceil(a.v); }
HWY_INLINE Lanes Floor(Lanes a) { return hn::Floor(a.v); }
HWY_INLINE Lanes FusedMulAdd(Lanes a, Lanes b, Lanes c) { return hn::MulAdd(a.v, b.v, c.v); }
#endif

}  // namespace
#if !defined(__CUDACC__)
HWY_AFTER_NAMESPACE();
#endif
#endif
