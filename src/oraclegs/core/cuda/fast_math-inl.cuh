#pragma once
// Functions of the hardware's own, for device code that can take an error of two units in the last place.

#include <cuda_runtime.h>

namespace oraclegs::cuda {

/// 2^e to 2 units in the last place, without the care that exp2f takes of denormal numbers: those become zero.
__device__ inline float Exp2(float e) {
#if defined(__CUDA_ARCH__)
  float result;
  asm("ex2.approx.ftz.f32 %0, %1;" : "=f"(result) : "f"(e));
  return result;
#else
  return exp2f(e);
#endif
}

/// 1 / x for normal x, to 1 unit in the last place.
__device__ inline float Reciprocal(float x) {
#if defined(__CUDA_ARCH__)
  float result;
  asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(result) : "f"(x));
  return result;
#else
  return 1.f / x;
#endif
}

}  // namespace oraclegs::cuda
