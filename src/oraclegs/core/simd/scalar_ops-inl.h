// The functions that the shared mathematics asks of a number type, for plain numbers on host and device.

#if defined(ORACLEGS_CORE_SIMD_SCALAR_OPS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_CORE_SIMD_SCALAR_OPS_INL_H_
#undef ORACLEGS_CORE_SIMD_SCALAR_OPS_INL_H_
#else
#define ORACLEGS_CORE_SIMD_SCALAR_OPS_INL_H_
#endif

#include <cmath>
#include <concepts>

#include "oraclegs/core/device_macros.h"

#if !defined(__CUDACC__)
#include <hwy/highway.h>
HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {
#else
namespace oraclegs::cuda {
#endif

ORACLEGS_HD inline bool And(bool a, bool b) { return a && b; }
template <std::floating_point T>
ORACLEGS_HD inline T Select(bool mask, T a, T b) {
  return mask ? a : b;
}
template <std::floating_point T>
ORACLEGS_HD inline T Min(T a, T b) {
  return a < b ? a : b;
}
template <std::floating_point T>
ORACLEGS_HD inline T Max(T a, T b) {
  return a > b ? a : b;
}
template <std::floating_point T>
ORACLEGS_HD inline T Sqrt(T a) {
  return std::sqrt(a);
}
template <std::floating_point T>
ORACLEGS_HD inline T Exp(T a) {
  return std::exp(a);
}
template <std::floating_point T>
ORACLEGS_HD inline T Log(T a) {
  return std::log(a);
}
template <std::floating_point T>
ORACLEGS_HD inline T Cos(T a) {
  return std::cos(a);
}
template <std::floating_point T>
ORACLEGS_HD inline T Sin(T a) {
  return std::sin(a);
}
template <std::floating_point T>
ORACLEGS_HD inline T Abs(T a) {
  return a < 0 ? -a : a;
}
/// a b + c, which compilers fuse where the device can.
template <std::floating_point T>
ORACLEGS_HD inline T MulAdd(T a, T b, T c) {
  return a * b + c;
}

}  // namespace
#if !defined(__CUDACC__)
HWY_AFTER_NAMESPACE();
#endif
#endif
