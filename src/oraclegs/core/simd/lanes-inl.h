// A SIMD vector that behaves like a float, so that splat_math-inl.h compiles for it. Re-included by Highway for every
// instruction set.

#if defined(ORACLEGS_CORE_SIMD_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_CORE_SIMD_LANES_INL_H_
#undef ORACLEGS_CORE_SIMD_LANES_INL_H_
#else
#define ORACLEGS_CORE_SIMD_LANES_INL_H_
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// 16 lanes at most: a block of 4 x 4 pixels or tiles' blocks is one vector on AVX-512, two on AVX2, four on SSE4 and
/// NEON.
using FloatTag = hn::CappedTag<float, 16>;
using IntTag = hn::RebindToSigned<FloatTag>;
using FloatVec = hn::Vec<FloatTag>;
using IntVec = hn::Vec<IntTag>;
using FloatMask = hn::Mask<FloatTag>;
inline constexpr int kLanes = static_cast<int>(hn::MaxLanes(FloatTag()));

struct LanesMask {
  FloatMask m;
};

struct Lanes {
  FloatVec v;

  HWY_INLINE Lanes() = default;
  HWY_INLINE Lanes(FloatVec x) : v(x) {}                                         // NOLINT: implicit as between numbers
  HWY_INLINE Lanes(float x) : v(hn::Set(FloatTag(), x)) {}                       // NOLINT
  HWY_INLINE Lanes(double x) : v(hn::Set(FloatTag(), static_cast<float>(x))) {}  // NOLINT
};

HWY_INLINE Lanes operator+(Lanes a, Lanes b) { return hn::Add(a.v, b.v); }
HWY_INLINE Lanes operator-(Lanes a, Lanes b) { return hn::Sub(a.v, b.v); }
HWY_INLINE Lanes operator*(Lanes a, Lanes b) { return hn::Mul(a.v, b.v); }
HWY_INLINE Lanes operator/(Lanes a, Lanes b) { return hn::Div(a.v, b.v); }
HWY_INLINE Lanes operator-(Lanes a) { return hn::Neg(a.v); }
HWY_INLINE LanesMask operator<(Lanes a, Lanes b) { return {hn::Lt(a.v, b.v)}; }
HWY_INLINE LanesMask operator>(Lanes a, Lanes b) { return {hn::Gt(a.v, b.v)}; }
HWY_INLINE LanesMask operator<=(Lanes a, Lanes b) { return {hn::Le(a.v, b.v)}; }
HWY_INLINE LanesMask operator>=(Lanes a, Lanes b) { return {hn::Ge(a.v, b.v)}; }
HWY_INLINE LanesMask And(LanesMask a, LanesMask b) { return {hn::And(a.m, b.m)}; }
HWY_INLINE Lanes Select(LanesMask m, Lanes a, Lanes b) { return hn::IfThenElse(m.m, a.v, b.v); }
HWY_INLINE Lanes Min(Lanes a, Lanes b) { return hn::Min(a.v, b.v); }
HWY_INLINE Lanes Max(Lanes a, Lanes b) { return hn::Max(a.v, b.v); }
HWY_INLINE Lanes Sqrt(Lanes a) { return hn::Sqrt(a.v); }
HWY_INLINE Lanes Exp(Lanes a) { return hn::Exp(FloatTag(), a.v); }
HWY_INLINE Lanes Log(Lanes a) { return hn::Log(FloatTag(), a.v); }
HWY_INLINE Lanes Cos(Lanes a) { return hn::Cos(FloatTag(), a.v); }
HWY_INLINE Lanes Sin(Lanes a) { return hn::Sin(FloatTag(), a.v); }
HWY_INLINE Lanes Abs(Lanes a) { return hn::Abs(a.v); }
HWY_INLINE Lanes MulAdd(Lanes a, Lanes b, Lanes c) { return hn::MulAdd(a.v, b.v, c.v); }

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
