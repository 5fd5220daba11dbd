#include "oraclegs/train/regularizers.h"

#include <algorithm>

#include "oraclegs/core/hwy_targets.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/render/render.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "oraclegs/train/regularizers.cpp"
// clang-format off: foreach_target must come before the other Highway headers
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "oraclegs/core/simd/lanes-inl.h"
// After the lanes, whose functions it calls.
#include "oraclegs/train/step_math-inl.h"

#ifndef ORACLEGS_TRAIN_REGULARIZERS_ONCE_
#define ORACLEGS_TRAIN_REGULARIZERS_ONCE_
namespace oraclegs {

struct RegularizerArrays {
  const float *log_scales, *logits;
  float *grad_log_scales, *grad_logits;
  RegularizerWeights weights;
};

}  // namespace oraclegs
#endif

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

/// Adds d/d(logit) over `count` entries; returns the sum of opacities.
double RegularizeOpacities(const RegularizerArrays& a, int64_t count) {
  const FloatTag d;
  const Lanes weight(a.weights.opacity);
  Lanes sum(0.f);
  int64_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    const Lanes opacity = Sigmoid(Lanes(hn::LoadU(d, a.logits + i)));
    const Lanes g = OpacityRegularizer(opacity, weight);
    hn::StoreU((Lanes(hn::LoadU(d, a.grad_logits + i)) + g).v, d, a.grad_logits + i);
    sum = sum + opacity;
  }
  double total = hn::GetLane(hn::SumOfLanes(d, sum.v));
  HWY_ALIGN float lane[kLanes];
  for (; i < count; ++i) {
    const Lanes opacity = Sigmoid(Lanes(a.logits[i]));
    hn::Store(OpacityRegularizer(opacity, weight).v, d, lane);
    a.grad_logits[i] += lane[0];
    total += hn::GetLane(opacity.v);
  }
  return total;
}

/// Adds d/d(log scale) over `count` entries of the flat [N,3] array; returns the sum of scales.
double RegularizeScales(const RegularizerArrays& a, int64_t count) {
  const FloatTag d;
  Lanes sum(0.f);
  int64_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    const Lanes scale = BoundedExp(Lanes(hn::LoadU(d, a.log_scales + i)));
    const Lanes g(hn::LoadU(d, a.grad_log_scales + i));
    hn::StoreU(AddScaleRegularizer(scale, Lanes(a.weights.scale), g).v, d, a.grad_log_scales + i);
    sum = sum + scale;
  }
  double total = hn::GetLane(hn::SumOfLanes(d, sum.v));
  for (; i < count; ++i) {
    const float scale = hn::GetLane(BoundedExp(Lanes(a.log_scales[i])).v);
    a.grad_log_scales[i] = AddScaleRegularizer(scale, a.weights.scale, a.grad_log_scales[i]);
    total += scale;
  }
  return total;
}

RegularizerSums RegularizeBlock(const RegularizerArrays& arrays, int64_t count) {
  return {RegularizeOpacities(arrays, count), RegularizeScales(arrays, 3 * count)};
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace oraclegs {
namespace {

HWY_EXPORT(RegularizeBlock);

}  // namespace

void Regularizers::Begin(const Gaussians& gaussians, const RegularizerOptions& options) {
  gaussians.Check("Regularizers");
  params_ = gaussians.Rows();
  weights_ = options.PerEntry(gaussians.size());
  sums_.resize((gaussians.size() + kGradBlock - 1) / kGradBlock);
}

void Regularizers::AddTo(int64_t begin, int64_t end, const GaussianRows& grads) {
  const RegularizerWeights weights{static_cast<float>(weights_.opacity), static_cast<float>(weights_.scale)};
  for (int64_t first = begin; first < end; first += kGradBlock) {
    const GaussianRows params = params_.From(first), out = grads.From(first - begin);
    sums_[first / kGradBlock] = HWY_DYNAMIC_DISPATCH(RegularizeBlock)(
        {params.log_scales, params.opacity_logits, out.log_scales, out.opacity_logits, weights},
        std::min(kGradBlock, end - first));
  }
}

double Regularizers::Value() const {
  RegularizerSums total;
  for (const RegularizerSums& block : sums_) {
    total.opacity += block.opacity;
    total.scale += block.scale;
  }
  return sums_.empty() ? 0 : weights_.opacity * total.opacity + weights_.scale * total.scale;
}

double AddRegularizers(const Gaussians& gaussians, const RegularizerOptions& options, Gaussians* grads) {
  grads->Check("AddRegularizers grads");
  const int64_t n = gaussians.size();
  if (grads->size() != n) throw ShapeError("AddRegularizers: gradients of {} Gaussians, expected {}", grads->size(), n);
  Regularizers regularizers;
  regularizers.Begin(gaussians, options);
  const GaussianRows rows = grads->Rows();
  ParallelBlocks(n, kGradBlock, [&](int64_t begin, int64_t end) { regularizers.AddTo(begin, end, rows.From(begin)); });
  return regularizers.Value();
}

}  // namespace oraclegs
#endif
