#pragma once
// Two neighbouring bfloat16 numbers in 32 bits, as the kernels read and write them; all they compute is float32.

#include <cstdint>

namespace oraclegs::cuda {

__device__ inline float2 Unpack(unsigned pair) {
  return {__uint_as_float(pair << 16), __uint_as_float(pair & 0xffff0000u)};
}

/// Rounded to the nearest, ties to even.
__device__ inline unsigned Pack(float2 pair) {
#if defined(__CUDA_ARCH__)
  unsigned bits;
  asm("cvt.rn.bf16x2.f32 %0, %1, %2;" : "=r"(bits) : "f"(pair.y), "f"(pair.x));
  return bits;
#else
  const auto rounded = [](float x) {
    const unsigned bits = __float_as_uint(x);
    return x != x ? 0x7fffu : (bits + 0x7fffu + (bits >> 16 & 1u)) >> 16;
  };
  return rounded(pair.x) | rounded(pair.y) << 16;
#endif
}

/// One number.
__device__ inline float Widen(uint16_t bits) { return __uint_as_float(static_cast<unsigned>(bits) << 16); }

__device__ inline const unsigned* Pairs(const uint16_t* numbers) { return reinterpret_cast<const unsigned*>(numbers); }
__device__ inline unsigned* Pairs(uint16_t* numbers) { return reinterpret_cast<unsigned*>(numbers); }

}  // namespace oraclegs::cuda
