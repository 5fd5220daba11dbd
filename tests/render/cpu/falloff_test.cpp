// The fast exponential, at every float of its range and for every instruction set.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/cpu/falloff_test.cpp"
#include "oraclegs/core/hwy_targets.h"
// clang-format off: foreach_target must come before the other Highway headers
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "oraclegs/render/cpu/falloff-inl.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

/// Largest relative error of Exp2Where over the floats from `first` to `last`, both negative, `stride` floats apart.
double LargestExp2Error(float first, float last, uint32_t stride) {
  const FloatTag d;
  double largest = 0;
  HWY_ALIGN float x[kLanes], y[kLanes];
  for (uint32_t bits = std::bit_cast<uint32_t>(first); bits < std::bit_cast<uint32_t>(last); bits += stride * kLanes) {
    for (int lane = 0; lane < kLanes; ++lane)
      x[lane] = std::bit_cast<float>(bits + stride * static_cast<uint32_t>(lane));
    const FloatVec v = hn::Load(d, x);
    hn::Store(Exp2Where(hn::Le(v, hn::Zero(d)), v), d, y);
    for (int lane = 0; lane < kLanes; ++lane) {
      const double exact = std::exp2(static_cast<double>(x[lane]));
      largest = std::max(largest, std::abs(y[lane] - exact) / exact);
    }
  }
  return largest;
}

/// Whether lanes outside of `where` come out as zero, whatever stands there.
bool OthersAreZero() {
  const FloatTag d;
  for (const float x : {-1e30f, -200.f, -3.f, 0.f, 1e15f, -INFINITY}) {
    const FloatVec v = hn::Set(d, x);
    if (!hn::AllTrue(d, hn::Eq(Exp2Where(hn::Lt(hn::Zero(d), hn::Zero(d)), v), hn::Zero(d)))) return false;
  }
  return true;
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "render/cpu/every_target.h"

namespace oraclegs {
namespace {

HWY_EXPORT(LargestExp2Error);
HWY_EXPORT(OthersAreZero);

class Exp2Where : public EveryTarget {};

TEST_P(Exp2Where, StaysWithinItsBound) {
  // alpha is above 1/255, so x above -8; of the many floats near zero some are looked at.
  EXPECT_LT(HWY_DYNAMIC_DISPATCH(LargestExp2Error)(-0.25f, -8.f, 5), 2.9e-6);
  EXPECT_LT(HWY_DYNAMIC_DISPATCH(LargestExp2Error)(-1e-30f, -0.25f, 961), 2.9e-6);
}

TEST_P(Exp2Where, IsZeroElsewhere) { EXPECT_TRUE(HWY_DYNAMIC_DISPATCH(OthersAreZero)()); }

INSTANTIATE_FOR_EVERY_TARGET(Exp2Where);

}  // namespace
}  // namespace oraclegs
#endif
