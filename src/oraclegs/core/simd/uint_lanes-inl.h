// A SIMD vector that behaves like a uint32_t, and the random numbers of core/rng.h in lanes. Re-included by Highway for
// every instruction set.

#if defined(ORACLEGS_CORE_SIMD_UINT_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_CORE_SIMD_UINT_LANES_INL_H_
#undef ORACLEGS_CORE_SIMD_UINT_LANES_INL_H_
#else
#define ORACLEGS_CORE_SIMD_UINT_LANES_INL_H_
#endif

#include <cstdint>

#include "oraclegs/core/device_macros.h"
#include "oraclegs/core/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

using UintTag = hn::RebindToUnsigned<FloatTag>;
using UintVec = hn::Vec<UintTag>;

struct UintLanes {
  UintVec v;

  HWY_INLINE UintLanes() = default;
  HWY_INLINE UintLanes(UintVec x) : v(x) {}  // NOLINT: implicit as between numbers
  HWY_INLINE explicit UintLanes(uint32_t x) : v(hn::Set(UintTag(), x)) {}
  /// first, first + 1, ...
  static HWY_INLINE UintLanes From(uint32_t first) {
    return hn::Add(hn::Iota(UintTag(), 0), hn::Set(UintTag(), first));  // Iota of an unknown number goes through memory
  }
};

HWY_INLINE UintLanes operator^(UintLanes a, UintLanes b) { return hn::Xor(a.v, b.v); }

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void MultiplyWide(UintLanes a, uint32_t b, UintLanes* high, UintLanes* low) {
  const uint64_t product = uint64_t{hn::GetLane(a.v)} * b;
  *high = UintLanes(static_cast<uint32_t>(product >> 32));
  *low = UintLanes(static_cast<uint32_t>(product));
}
#else
HWY_INLINE void MultiplyWide(UintLanes a, uint32_t b, UintLanes* high, UintLanes* low) {
  const UintTag d;
  const hn::Repartition<uint64_t, UintTag> wide;
  const UintVec factor = hn::Set(d, b);
  const auto even = hn::MulEven(a.v, factor);
  const auto odd = hn::MulEven(hn::BitCast(d, hn::ShiftRight<32>(hn::BitCast(wide, a.v))), factor);
  low->v = hn::OddEven(hn::BitCast(d, hn::ShiftLeft<32>(odd)), hn::BitCast(d, even));
  high->v = hn::OddEven(hn::BitCast(d, odd), hn::BitCast(d, hn::ShiftRight<32>(even)));
}
#endif

#include "oraclegs/core/philox_rounds-inl.h"

/// OpenUniform of core/rng.h.
HWY_INLINE Lanes OpenUniform(UintLanes bits) {
  const Lanes whole = hn::ConvertTo(FloatTag(), hn::BitCast(IntTag(), hn::ShiftRight<9>(bits.v)));
  return (whole + Lanes(0.5f)) * Lanes(0x1.0p-23f);
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
