// Vectors of float32 from bfloat16 in memory and back, with the roundings of core/bfloat16.h. Re-included by Highway
// for every instruction set.

#if defined(ORACLEGS_CORE_SIMD_BFLOAT16_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_CORE_SIMD_BFLOAT16_INL_H_
#undef ORACLEGS_CORE_SIMD_BFLOAT16_INL_H_
#else
#define ORACLEGS_CORE_SIMD_BFLOAT16_INL_H_
#endif

#include "oraclegs/core/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

HWY_INLINE Lanes LoadBfloat16(const uint16_t* from) {
  const hn::RebindToUnsigned<FloatTag> wide;
  const hn::Rebind<uint16_t, FloatTag> narrow;
  return Lanes(hn::BitCast(FloatTag(), hn::ShiftLeft<16>(hn::PromoteTo(wide, hn::LoadU(narrow, from)))));
}

HWY_INLINE void StoreBfloat16(Lanes value, uint16_t* to) {
  const hn::RebindToUnsigned<FloatTag> wide;
  const hn::Rebind<uint16_t, FloatTag> narrow;
  const auto bits = hn::BitCast(wide, value.v);
  const auto odd = hn::And(hn::ShiftRight<16>(bits), hn::Set(wide, 1));
  const auto rounded = hn::ShiftRight<16>(hn::Add(hn::Add(bits, hn::Set(wide, 0x7fff)), odd));
  // Below 65536, so that nothing saturates.
  hn::StoreU(hn::DemoteTo(narrow, hn::BitCast(IntTag(), rounded)), narrow, to);
}

HWY_INLINE void StoreBfloat16AtRandom(Lanes value, hn::VFromD<hn::RebindToUnsigned<FloatTag>> random, uint16_t* to) {
  const hn::RebindToUnsigned<FloatTag> wide;
  const hn::Rebind<uint16_t, FloatTag> narrow;
  const auto rounded = hn::ShiftRight<16>(hn::Add(hn::BitCast(wide, value.v), hn::ShiftRight<16>(random)));
  hn::StoreU(hn::DemoteTo(narrow, hn::BitCast(IntTag(), rounded)), narrow, to);
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
