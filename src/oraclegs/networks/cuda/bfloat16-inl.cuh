#pragma once
// Two neighboring bfloat16 numbers in 32 bits, as the kernels read and write them; arithmetic is in float32.

#include "oraclegs/core/bfloat16.h"

namespace oraclegs::cuda {

__device__ inline float2 Unpack(unsigned pair) {
  return {__uint_as_float(pair << 16), __uint_as_float(pair & 0xffff0000u)};
}

/// Rounds to the nearest, ties to even.
__device__ inline unsigned Pack(float2 pair) {
#if defined(__CUDA_ARCH__)
  unsigned bits;
  asm("cvt.rn.bf16x2.f32 %0, %1, %2;" : "=r"(bits) : "f"(pair.y), "f"(pair.x));
  return bits;
#else
  return ToBfloat16(pair.x) | static_cast<unsigned>(ToBfloat16(pair.y)) << 16;
#endif
}

__device__ inline const unsigned* Pairs(const uint16_t* numbers) { return reinterpret_cast<const unsigned*>(numbers); }
__device__ inline unsigned* Pairs(uint16_t* numbers) { return reinterpret_cast<unsigned*>(numbers); }

}  // namespace oraclegs::cuda
