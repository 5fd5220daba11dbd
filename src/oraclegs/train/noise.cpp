// A vector holds neighboring Gaussians; the mathematics is noise_math-inl.h.

#include "oraclegs/train/noise.h"

#include <algorithm>

#include "oraclegs/core/hwy_targets.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "oraclegs/train/noise.cpp"
// clang-format off: foreach_target must come before the other Highway headers
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "oraclegs/core/simd/lanes-inl.h"
#include "oraclegs/core/simd/uint_lanes-inl.h"
// After the lanes, whose functions it calls.
#include "oraclegs/train/noise_math-inl.h"

#ifndef ORACLEGS_TRAIN_NOISE_ONCE_
#define ORACLEGS_TRAIN_NOISE_ONCE_
namespace oraclegs {

struct NoiseArrays {
  float* means;
  const float *log_scales, *quats, *logits;
  const float* epsilon;  ///< [N,3]; null = drawn

  NoiseArrays From(int64_t i) const {
    return {means + 3 * i, log_scales + 3 * i, quats + 4 * i, logits + i, epsilon ? epsilon + 3 * i : nullptr};
  }
};

}  // namespace oraclegs
#endif

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

/// Moves one vector of Gaussians; `at` points to its first one.
HWY_INLINE void MoveVector(const NoiseArrays& at, const NoiseConstants& noise, uint32_t first_index) {
  const FloatTag d;
  const Lanes gate = NoiseGate(Lanes(hn::LoadU(d, at.logits)));
  const LanesMask moves = IsMoved(gate);
  if (hn::AllFalse(d, moves.m)) return;
  Lanes e[3], q[4], log_scale[3], mean[3];
  if (at.epsilon) {
    hn::LoadInterleaved3(d, at.epsilon, e[0].v, e[1].v, e[2].v);
  } else {
    DrawNormals(noise, UintLanes::From(first_index), e);
  }
  hn::LoadInterleaved4(d, at.quats, q[0].v, q[1].v, q[2].v, q[3].v);
  hn::LoadInterleaved3(d, at.log_scales, log_scale[0].v, log_scale[1].v, log_scale[2].v);
  hn::LoadInterleaved3(d, at.means, mean[0].v, mean[1].v, mean[2].v);
  Displace(gate, Lanes(noise.strength), q, log_scale, e);
  for (int k = 0; k < 3; ++k) mean[k] = mean[k] + Select(moves, e[k], Lanes(0.f));
  hn::StoreInterleaved3(mean[0].v, mean[1].v, mean[2].v, d, at.means);
}

/// Adds the noise to Gaussians [begin, end).
void AddNoiseBlock(const NoiseArrays& arrays, const NoiseConstants& noise, int64_t begin, int64_t end) {
  int64_t i = begin;
  for (; i + kLanes <= end; i += kLanes) MoveVector(arrays.From(i), noise, static_cast<uint32_t>(i));
  if (i == end) return;
  // The remainder, in a vector of its own.
  float means[3 * kLanes] = {}, log_scales[3 * kLanes] = {}, quats[4 * kLanes], logits[kLanes] = {};
  float epsilon[3 * kLanes] = {};
  std::fill(std::begin(quats), std::end(quats), 1.f);
  const NoiseArrays rest = arrays.From(i);
  const int64_t count = end - i;
  std::copy_n(rest.means, 3 * count, means);
  std::copy_n(rest.log_scales, 3 * count, log_scales);
  std::copy_n(rest.quats, 4 * count, quats);
  std::copy_n(rest.logits, count, logits);
  if (rest.epsilon) std::copy_n(rest.epsilon, 3 * count, epsilon);
  MoveVector({means, log_scales, quats, logits, rest.epsilon ? epsilon : nullptr}, noise, static_cast<uint32_t>(i));
  std::copy_n(means, 3 * count, rest.means);
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace oraclegs {
namespace {

HWY_EXPORT(AddNoiseBlock);

constexpr int64_t kNoiseGrain = 1024;

NoiseArrays ArraysOf(const Gaussians& gaussians) {
  const GaussianRows rows = gaussians.Rows();
  return {rows.means, rows.log_scales, rows.quats, rows.opacity_logits, nullptr};
}

}  // namespace

NoiseConstants MeansNoise::Constants() const {
  return {seed, static_cast<uint32_t>(iteration), static_cast<float>(kNoiseRate * lr_means)};
}

void AddNoiseToBlock(const MeansNoise& noise, int64_t begin, int64_t end, Gaussians* gaussians) {
  HWY_DYNAMIC_DISPATCH(AddNoiseBlock)(ArraysOf(*gaussians), noise.Constants(), begin, end);
}

void AddNoise(const MeansNoise& noise, Gaussians* gaussians) {
  gaussians->Check("AddNoise");
  ParallelBlocks(gaussians->size(), kNoiseGrain,
                 [&](int64_t begin, int64_t end) { AddNoiseToBlock(noise, begin, end, gaussians); });
}

void AddNoiseFrom(const Buffer<float>& epsilon, double lr_means, Gaussians* gaussians) {
  gaussians->Check("AddNoiseFrom");
  RequireShape("AddNoiseFrom", "epsilon", epsilon, {gaussians->size(), 3});
  NoiseArrays arrays = ArraysOf(*gaussians);
  arrays.epsilon = epsilon.data();
  HWY_DYNAMIC_DISPATCH(AddNoiseBlock)(arrays, MeansNoise{0, 0, lr_means}.Constants(), 0, gaussians->size());
}

}  // namespace oraclegs
#endif
