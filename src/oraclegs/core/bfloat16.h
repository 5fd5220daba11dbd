#pragma once
// bfloat16: the upper half of a float32, so of its range but with 8 bits of precision.

#include <cstdint>

#include "oraclegs/core/device_macros.h"

namespace oraclegs {

/// The nearest bfloat16, of two equally near ones the even one; what is too large becomes infinite. Not for NaN, which
/// may become a number.
ORACLEGS_HD inline uint16_t ToBfloat16(float value) {
  const uint32_t bits = __builtin_bit_cast(uint32_t, value);
  return static_cast<uint16_t>((bits + 0x7fff + (bits >> 16 & 1)) >> 16);
}

/// One of the two bfloat16 numbers next to a finite value, or the value itself, by the upper 16 bits of `random`: in
/// the mean over all of them exactly the value.
ORACLEGS_HD inline uint16_t ToBfloat16AtRandom(float value, uint32_t random) {
  return static_cast<uint16_t>((__builtin_bit_cast(uint32_t, value) + (random >> 16)) >> 16);
}

ORACLEGS_HD inline float FromBfloat16(uint16_t bits) { return __builtin_bit_cast(float, uint32_t{bits} << 16); }

}  // namespace oraclegs
