// A vector holds neighboring Gaussians; the mathematics is opacity_factor_math-inl.h.

#include "oraclegs/train/opacity_factors.h"

#include <algorithm>

#include "oraclegs/core/hwy_targets.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/train/step_constants.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "oraclegs/train/opacity_factors.cpp"
// clang-format off: foreach_target must come before the other Highway headers
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "oraclegs/core/simd/lanes-inl.h"
#include "oraclegs/core/simd/uint_lanes-inl.h"
// After the lanes, whose functions it calls.
#include "oraclegs/train/opacity_factor_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

/// Factors of Gaussians [begin, end).
void DrawFactors(const OpacityConstants& constants, int64_t begin, int64_t end, float* factors) {
  const FloatTag d;
  for (int64_t i = begin; i < end; i += kLanes) {
    const Lanes factor = OpacityFactor<Lanes>(constants, UintLanes::From(static_cast<uint32_t>(i)));
    if (end - i >= kLanes) {
      hn::StoreU(factor.v, d, factors + i);
    } else {
      HWY_ALIGN float rest[kLanes];
      hn::Store(factor.v, d, rest);
      std::copy_n(rest, end - i, factors + i);
    }
  }
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace oraclegs {
namespace {

HWY_EXPORT(DrawFactors);

constexpr int64_t kOpacityGrain = 4096;  // Gaussians a task

}  // namespace

double DropProbability(double dropout, int64_t iteration, int64_t iterations) {
  if (iteration >= iterations) return 0;
  return dropout * static_cast<double>(iteration) / static_cast<double>(iterations);
}

void DrawOpacityFactors(const OpacityPerturbation& perturbation, const Buffer<float>& factors) {
  RequireShape("DrawOpacityFactors", "factors", factors, {-1});
  if (!(perturbation.drop >= 0 && perturbation.drop < 1) || !(perturbation.noise >= 0)) {
    throw ShapeError("DrawOpacityFactors: drop is {} and noise {}, must be in [0,1) and at least 0", perturbation.drop,
                     perturbation.noise);
  }
  const OpacityConstants constants{perturbation.seed, static_cast<uint32_t>(perturbation.iteration),
                                   static_cast<float>(perturbation.drop), static_cast<float>(perturbation.noise)};
  ParallelBlocks(factors.count(), kOpacityGrain, [&](int64_t begin, int64_t end) {
    HWY_DYNAMIC_DISPATCH(DrawFactors)(constants, begin, end, factors.data());
  });
}

}  // namespace oraclegs
#endif
