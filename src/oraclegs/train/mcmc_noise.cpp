// What 3DGS-MCMC does to every Gaussian in every iteration: noise and regularisers. A vector holds neighbouring
// Gaussians; the random numbers are those of Philox::Draw(seed, kNoise, iteration << 32 | index).

#include <algorithm>
#include <cmath>

#include "oraclegs/core/hwy_targets.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/render/render.h"
#include "oraclegs/train/mcmc.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "oraclegs/train/mcmc_noise.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After highway.h.
#include <hwy/contrib/math/math-inl.h>

#ifndef ORACLEGS_TRAIN_MCMC_NOISE_ONCE_
#define ORACLEGS_TRAIN_MCMC_NOISE_ONCE_
namespace oraclegs {

struct NoiseArrays {
  float* means;
  const float *log_scales, *quats, *logits;
  const float* epsilon;  ///< [N,3], or null: drawn
};

struct NoiseStep {
  uint64_t seed;
  uint32_t iteration;
  float strength;  ///< 5e5 * lr_means
};

struct RegularizerArrays {
  const float *log_scales, *logits;
  float *grad_log_scales, *grad_logits;
  float scale_weight, opacity_weight;  ///< per entry
};

}  // namespace oraclegs
#endif

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<float>;
using DU = hn::ScalableTag<uint32_t>;
using V = hn::Vec<D>;
using VU = hn::Vec<DU>;

HWY_INLINE V Set(float x) { return hn::Set(D(), x); }

HWY_INLINE V ExpClamped(V x) { return hn::Exp(D(), hn::Min(hn::Max(x, Set(-kExpLimit)), Set(kExpLimit))); }

HWY_INLINE V Sigmoid(V x) { return hn::Div(Set(1.f), hn::Add(Set(1.f), ExpClamped(hn::Neg(x)))); }

#if HWY_TARGET == HWY_SCALAR
/// Philox::Draw at neighbouring counters.
HWY_INLINE void DrawWords(const NoiseStep& step, uint32_t first_index, VU* x) {
  const Philox words = Philox::Draw(step.seed, static_cast<uint64_t>(RandomStream::kNoise),
                                    uint64_t{step.iteration} << 32 | first_index);
  for (int i = 0; i < 4; ++i) x[i] = hn::Set(DU(), words.x[i]);
}
#else
/// Both halves of the 64-bit products a * b.
HWY_INLINE void MultiplyWide(VU a, uint32_t b, VU* high, VU* low) {
  const DU d;
  const hn::Repartition<uint64_t, DU> wide;
  const VU factor = hn::Set(d, b);
  const auto even = hn::MulEven(a, factor);
  const auto odd = hn::MulEven(hn::BitCast(d, hn::ShiftRight<32>(hn::BitCast(wide, a))), factor);
  *low = hn::OddEven(hn::BitCast(d, hn::ShiftLeft<32>(odd)), hn::BitCast(d, even));
  *high = hn::OddEven(hn::BitCast(d, odd), hn::BitCast(d, hn::ShiftRight<32>(even)));
}

/// Philox::Draw at neighbouring counters.
HWY_INLINE void DrawWords(const NoiseStep& step, uint32_t first_index, VU* x) {
  const DU d;
  x[0] = hn::Iota(d, first_index);
  x[1] = hn::Set(d, step.iteration);
  x[2] = hn::Set(d, static_cast<uint32_t>(RandomStream::kNoise));
  x[3] = hn::Zero(d);
  uint32_t k0 = static_cast<uint32_t>(step.seed), k1 = static_cast<uint32_t>(step.seed >> 32);
  for (int round = 0; round < 10; ++round) {
    VU high0, low0, high1, low1;
    MultiplyWide(x[0], 0xD2511F53u, &high0, &low0);
    MultiplyWide(x[2], 0xCD9E8D57u, &high1, &low1);
    x[0] = hn::Xor(hn::Xor(high1, x[1]), hn::Set(d, k0));
    x[1] = low1;
    x[2] = hn::Xor(hn::Xor(high0, x[3]), hn::Set(d, k1));
    x[3] = low0;
    k0 += 0x9E3779B9u;
    k1 += 0xBB67AE85u;
  }
}

#endif

/// OpenUniform of core/rng.h, in lanes.
HWY_INLINE V Uniform(VU bits) {
  const V whole = hn::ConvertTo(D(), hn::BitCast(hn::RebindToSigned<DU>(), hn::ShiftRight<9>(bits)));
  return hn::Mul(hn::Add(whole, Set(0.5f)), Set(0x1.0p-23f));
}

/// Standard normal numbers by Box and Muller: two from the first pair of words, one from the second.
HWY_INLINE void DrawNormals(const NoiseStep& step, uint32_t first_index, V* e) {
  const D d;
  VU words[4];
  DrawWords(step, first_index, words);
  const V turn = Set(6.2831853f);
  const V radius0 = hn::Sqrt(hn::Mul(Set(-2.f), hn::Log(d, Uniform(words[0]))));
  const V radius1 = hn::Sqrt(hn::Mul(Set(-2.f), hn::Log(d, Uniform(words[2]))));
  const V angle0 = hn::Mul(turn, Uniform(words[1])), angle1 = hn::Mul(turn, Uniform(words[3]));
  e[0] = hn::Mul(radius0, hn::Cos(d, angle0));
  e[1] = hn::Mul(radius0, hn::Sin(d, angle0));
  e[2] = hn::Mul(radius1, hn::Cos(d, angle1));
}

/// Sigma e = R S^2 R' e of the raw quaternion and log scales.
HWY_INLINE void TimesCovariance(const V* q, const V* log_scale, V* e) {
  const V norm2 = hn::MulAdd(q[0], q[0], hn::MulAdd(q[1], q[1], hn::MulAdd(q[2], q[2], hn::Mul(q[3], q[3]))));
  const V k = hn::Div(Set(2.f), norm2);  // 2 / |q|^2 normalises every product of two components
  const V kx = hn::Mul(k, q[1]), ky = hn::Mul(k, q[2]), kz = hn::Mul(k, q[3]);
  const V xx = hn::Mul(kx, q[1]), yy = hn::Mul(ky, q[2]), zz = hn::Mul(kz, q[3]);
  const V xy = hn::Mul(kx, q[2]), xz = hn::Mul(kx, q[3]), yz = hn::Mul(ky, q[3]);
  const V wx = hn::Mul(kx, q[0]), wy = hn::Mul(ky, q[0]), wz = hn::Mul(kz, q[0]);
  const V one = Set(1.f);
  const V r[3][3] = {{hn::Sub(one, hn::Add(yy, zz)), hn::Sub(xy, wz), hn::Add(xz, wy)},
                     {hn::Add(xy, wz), hn::Sub(one, hn::Add(xx, zz)), hn::Sub(yz, wx)},
                     {hn::Sub(xz, wy), hn::Add(yz, wx), hn::Sub(one, hn::Add(xx, yy))}};
  V a[3];
  for (int j = 0; j < 3; ++j) {
    const V s = ExpClamped(log_scale[j]);
    a[j] = hn::MulAdd(r[0][j], e[0], hn::MulAdd(r[1][j], e[1], hn::Mul(r[2][j], e[2])));
    a[j] = hn::Mul(hn::Mul(s, s), a[j]);
  }
  for (int i = 0; i < 3; ++i) {
    e[i] = hn::MulAdd(r[i][0], a[0], hn::MulAdd(r[i][1], a[1], hn::Mul(r[i][2], a[2])));
  }
}

/// One vector of Gaussians; the arrays begin with its first one.
HWY_INLINE void MoveVector(const NoiseArrays& at, const NoiseStep& step, uint32_t first_index) {
  const D d;
  const V opacity = Sigmoid(hn::LoadU(d, at.logits));
  const V gate = Sigmoid(hn::Mul(Set(-kGateSlope), hn::Sub(opacity, Set(kDeadOpacity))));
  const auto moves = hn::Ge(gate, Set(kMinNoiseGate));
  if (hn::AllFalse(d, moves)) return;
  V e[3], q[4], log_scale[3], mean[3];
  if (at.epsilon) {
    hn::LoadInterleaved3(d, at.epsilon, e[0], e[1], e[2]);
  } else {
    DrawNormals(step, first_index, e);
  }
  hn::LoadInterleaved4(d, at.quats, q[0], q[1], q[2], q[3]);
  hn::LoadInterleaved3(d, at.log_scales, log_scale[0], log_scale[1], log_scale[2]);
  hn::LoadInterleaved3(d, at.means, mean[0], mean[1], mean[2]);
  // Zero for those that stay: their gates would make subnormal numbers of what follows, which are slow.
  const V strength = hn::IfThenElseZero(moves, hn::Mul(gate, Set(step.strength)));
  for (V& x : e) x = hn::Mul(x, strength);
  TimesCovariance(q, log_scale, e);
  for (int i = 0; i < 3; ++i) mean[i] = hn::Add(mean[i], hn::IfThenElseZero(moves, e[i]));
  hn::StoreInterleaved3(mean[0], mean[1], mean[2], d, at.means);
}

HWY_INLINE NoiseArrays From(const NoiseArrays& a, int64_t i) {
  return {a.means + 3 * i, a.log_scales + 3 * i, a.quats + 4 * i, a.logits + i,
          a.epsilon ? a.epsilon + 3 * i : nullptr};
}

/// Gaussians [begin, end).
void AddNoiseBlock(const NoiseArrays& arrays, const NoiseStep& step, int64_t begin, int64_t end) {
  const D d;
  const int64_t lanes = static_cast<int64_t>(hn::Lanes(d));
  int64_t i = begin;
  for (; i + lanes <= end; i += lanes) MoveVector(From(arrays, i), step, static_cast<uint32_t>(i));
  if (i == end) return;
  constexpr size_t kLanes = hn::MaxLanes(D());
  float means[3 * kLanes] = {}, log_scales[3 * kLanes] = {}, quats[4 * kLanes], logits[kLanes] = {};
  float epsilon[3 * kLanes] = {};
  std::fill(std::begin(quats), std::end(quats), 1.f);
  const NoiseArrays rest = From(arrays, i);
  const int64_t count = end - i;
  std::copy_n(rest.means, 3 * count, means);
  std::copy_n(rest.log_scales, 3 * count, log_scales);
  std::copy_n(rest.quats, 4 * count, quats);
  std::copy_n(rest.logits, count, logits);
  if (rest.epsilon) std::copy_n(rest.epsilon, 3 * count, epsilon);
  MoveVector({means, log_scales, quats, logits, rest.epsilon ? epsilon : nullptr}, step, static_cast<uint32_t>(i));
  std::copy_n(means, 3 * count, rest.means);
}

/// Adds d/d(logit) over `count` entries; returns the sum of opacities.
double RegularizeOpacities(const RegularizerArrays& a, int64_t count) {
  const D d;
  const int64_t lanes = static_cast<int64_t>(hn::Lanes(d));
  const V weight = Set(a.opacity_weight);
  V sum = hn::Zero(d);
  const auto gradient = [&](V logit, V* opacity) {
    *opacity = Sigmoid(logit);
    return hn::Mul(weight, hn::Mul(*opacity, hn::Sub(Set(1.f), *opacity)));
  };
  V opacity;
  int64_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const V g = gradient(hn::LoadU(d, a.logits + i), &opacity);
    hn::StoreU(hn::Add(hn::LoadU(d, a.grad_logits + i), g), d, a.grad_logits + i);
    sum = hn::Add(sum, opacity);
  }
  double total = hn::GetLane(hn::SumOfLanes(d, sum));
  HWY_ALIGN float lane[hn::MaxLanes(D())];
  for (; i < count; ++i) {
    hn::Store(gradient(Set(a.logits[i]), &opacity), d, lane);
    a.grad_logits[i] += lane[0];
    total += hn::GetLane(opacity);
  }
  return total;
}

/// Adds d/d(log scale) over `count` entries of the flat [N,3] array; returns the sum of scales.
double RegularizeScales(const RegularizerArrays& a, int64_t count) {
  const D d;
  const int64_t lanes = static_cast<int64_t>(hn::Lanes(d));
  const V weight = Set(a.scale_weight);
  V sum = hn::Zero(d);
  int64_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const V scale = ExpClamped(hn::LoadU(d, a.log_scales + i));
    hn::StoreU(hn::MulAdd(weight, scale, hn::LoadU(d, a.grad_log_scales + i)), d, a.grad_log_scales + i);
    sum = hn::Add(sum, scale);
  }
  double total = hn::GetLane(hn::SumOfLanes(d, sum));
  for (; i < count; ++i) {
    const float scale = hn::GetLane(ExpClamped(Set(a.log_scales[i])));
    a.grad_log_scales[i] += a.scale_weight * scale;
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

HWY_EXPORT(AddNoiseBlock);
HWY_EXPORT(RegularizeBlock);

constexpr int64_t kGrain = 1024;

void MoveRows(const Buffer<float>& epsilon, const NoiseStep& step, int64_t begin, int64_t end, Gaussians* gaussians) {
  const GaussianRows rows = gaussians->Rows();
  const NoiseArrays arrays{rows.means, rows.log_scales, rows.quats, rows.opacity_logits,
                           epsilon.defined() ? epsilon.data() : nullptr};
  HWY_DYNAMIC_DISPATCH(AddNoiseBlock)(arrays, step, begin, end);
}

}  // namespace

void AddNoiseToBlock(const MeansNoise& noise, int64_t begin, int64_t end, Gaussians* gaussians) {
  const NoiseStep step{noise.seed, static_cast<uint32_t>(noise.iteration),
                       static_cast<float>(kNoiseRate * noise.lr_means)};
  MoveRows({}, step, begin, end, gaussians);
}

void AddNoise(const MeansNoise& noise, Gaussians* gaussians) {
  gaussians->Check("AddNoise");
  ParallelBlocks(gaussians->size(), kGrain,
                 [&](int64_t begin, int64_t end) { AddNoiseToBlock(noise, begin, end, gaussians); });
}

void AddNoiseFrom(const Buffer<float>& epsilon, double lr_means, Gaussians* gaussians) {
  gaussians->Check("AddNoiseFrom");
  RequireShape("AddNoiseFrom", "epsilon", epsilon, {gaussians->size(), 3});
  MoveRows(epsilon, {0, 0, static_cast<float>(kNoiseRate * lr_means)}, 0, gaussians->size(), gaussians);
}

void Regularizers::Begin(const Gaussians& gaussians, double opacity_reg, double scale_reg) {
  gaussians.Check("Regularizers");
  const double n = static_cast<double>(gaussians.size());
  params_ = gaussians.Rows();
  opacity_weight_ = opacity_reg / n;
  scale_weight_ = scale_reg / (3 * n);
  sums_.resize((gaussians.size() + kGradBlock - 1) / kGradBlock);
}

void Regularizers::AddTo(int64_t begin, int64_t end, const GaussianRows& grads) {
  for (int64_t first = begin; first < end; first += kGradBlock) {
    const GaussianRows params = params_.From(first), out = grads.From(first - begin);
    sums_[first / kGradBlock] = HWY_DYNAMIC_DISPATCH(RegularizeBlock)(
        {params.log_scales, params.opacity_logits, out.log_scales, out.opacity_logits,
         static_cast<float>(scale_weight_), static_cast<float>(opacity_weight_)},
        std::min(kGradBlock, end - first));
  }
}

double Regularizers::Value() const {
  RegularizerSums total;
  for (const RegularizerSums& block : sums_) {
    total.opacity += block.opacity;
    total.scale += block.scale;
  }
  return sums_.empty() ? 0 : opacity_weight_ * total.opacity + scale_weight_ * total.scale;
}

double AddRegularizers(const Gaussians& gaussians, double opacity_reg, double scale_reg, Gaussians* grads) {
  grads->Check("AddRegularizers grads");
  const int64_t n = gaussians.size();
  if (grads->size() != n) throw ShapeError("AddRegularizers: gradients of {} Gaussians, expected {}", grads->size(), n);
  Regularizers regularizers;
  regularizers.Begin(gaussians, opacity_reg, scale_reg);
  const GaussianRows rows = grads->Rows();
  ParallelBlocks(n, kGradBlock, [&](int64_t begin, int64_t end) { regularizers.AddTo(begin, end, rows.From(begin)); });
  return regularizers.Value();
}

}  // namespace oraclegs
#endif
