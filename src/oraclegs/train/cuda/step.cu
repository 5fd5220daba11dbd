#include "oraclegs/train/cuda/step.h"

#include "oraclegs/core/bfloat16.h"
#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/core/cuda/sums-inl.cuh"
#include "oraclegs/render/cuda/gaussian_backward-inl.cuh"
#include "oraclegs/train/noise_math-inl.h"
#include "oraclegs/train/opacity_factor_math-inl.h"
#include "oraclegs/train/step_math-inl.h"

namespace oraclegs::cuda {
namespace {

static_assert(kStepBlock == kSumThreads);

constexpr int kColors = 3;  // floats of a row of sh that have a learning rate of their own: the first coefficient's

__global__ void SumRegularizers(RegularizerInput in) {
  __shared__ double shared[kSumWarps];
  const int thread = static_cast<int>(threadIdx.x);
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kStepBlock + thread;
  double opacity = 0, scale = 0;
  if (i < in.count) {
    opacity = Sigmoid(in.params.opacity_logits[i]);
    for (int k = 0; k < 3; ++k) scale += BoundedExp(in.params.log_scales[3 * i + k]);
  }
  opacity = BlockSum(opacity, thread, shared);
  scale = BlockSum(scale, thread, shared);
  if (thread == 0) in.sums[blockIdx.x] = {opacity, scale};
}

/// All parameters of one Gaussian but its colors; also their gradients or one of their moments.
struct SmallRow {
  float mean[3], log_scale[3], quat[4], logit;
};

/// Loads whole rows at once, so that the loads overlap.
__device__ SmallRow LoadRow(const GaussianRows& rows, int64_t i) {
  SmallRow row;
  for (int k = 0; k < 3; ++k) row.mean[k] = rows.means[3 * i + k];
  for (int k = 0; k < 3; ++k) row.log_scale[k] = rows.log_scales[3 * i + k];
  for (int k = 0; k < 4; ++k) row.quat[k] = rows.quats[4 * i + k];
  row.logit = rows.opacity_logits[i];
  return row;
}

__device__ void StoreRow(const SmallRow& row, const GaussianRows& rows, int64_t i) {
  for (int k = 0; k < 3; ++k) rows.means[3 * i + k] = row.mean[k];
  for (int k = 0; k < 3; ++k) rows.log_scales[3 * i + k] = row.log_scale[k];
  for (int k = 0; k < 4; ++k) rows.quats[4 * i + k] = row.quat[k];
  rows.opacity_logits[i] = row.logit;
}

__device__ void MoveMean(const NoiseConstants& noise, int64_t i, SmallRow* row) {
  const float gate = NoiseGate(row->logit);
  if (!IsMoved(gate)) return;
  float e[3];
  DrawNormals(noise, static_cast<uint32_t>(i), e);
  Displace(gate, noise.strength, row->quat, row->log_scale, e);
  for (int k = 0; k < 3; ++k) row->mean[k] += e[k];
}

/// kCount numbers with one learning rate: pointers to the first of the parameters and of each moment.
struct AdamPointers {
  float *p, *m, *v;
};
template <int kCount>
__device__ void StepNumbers(const float* gradient, float rate, float correction2_root, const AdamPointers& at) {
  for (int k = 0; k < kCount; ++k) {
    AdamNumber<float> n{at.p[k], at.m[k], at.v[k]};
    StepNumber(gradient[k], rate, correction2_root, &n);
    at.p[k] = n.value, at.m[k] = n.m, at.v[k] = n.v;
  }
}

struct alignas(16) Four {
  float x[4];
};
/// Four bfloat16 numbers.
struct alignas(8) FourHalves {
  uint16_t x[4];
};

/// Takes the step of each Gaussian. Colors are stepped apart from the rest, four neighboring coefficients at a time:
/// rows of sh are 192 bytes, hence aligned to 16.
struct StepConsumer {
  StepConstants step;

  __device__ void ConsumeSmall(int64_t i, const GaussianGrad& grad) const {
    SmallRow p = LoadRow(step.params, i), m = LoadRow(step.moments.m, i), v = LoadRow(step.moments.v, i);
    const AdamConstants& adam = step.adam;
    const float root = adam.correction2_root;
    float log_scale[3];
    for (int k = 0; k < 3; ++k) {
      log_scale[k] = AddScaleRegularizer(BoundedExp(p.log_scale[k]), step.regularizers.scale, grad.log_scale[k]);
    }
    const float logit = grad.logit + OpacityRegularizer(Sigmoid(p.logit), step.regularizers.opacity);
    StepNumbers<3>(grad.mean, adam.means, root, {p.mean, m.mean, v.mean});
    StepNumbers<3>(log_scale, adam.log_scales, root, {p.log_scale, m.log_scale, v.log_scale});
    StepNumbers<4>(grad.quat, adam.quats, root, {p.quat, m.quat, v.quat});
    StepNumbers<1>(&logit, adam.opacity_logits, root, {&p.logit, &m.logit, &v.logit});
    StoreRow(m, step.moments.m, i);
    StoreRow(v, step.moments.v, i);
    if (step.moments.compact()) {
      float* sh_v = step.moments.sh_v + i;
      *sh_v = NextSecondMoment(MeanShSquare(grad.sh0[0], grad.sh0[1], grad.sh0[2]), *sh_v);
    }
    if (step.adds_noise) MoveMean(step.noise, i, &p);
    StoreRow(p, step.params, i);
  }

  /// Steps four coefficients. Those above the active degree have neither gradient nor moments and stay.
  __device__ void ConsumeSh(int64_t i, int first, float4 grad) const {
    if (step.moments.half()) return StepHalfSh(i, first, grad);
    if (step.moments.compact()) return StepCompactSh(i, first, grad);
    const int64_t start = i * kShFloats + first;
    Four* to_p = reinterpret_cast<Four*>(step.params.sh + start);
    Four* to_m = reinterpret_cast<Four*>(step.moments.m.sh + start);
    Four* to_v = reinterpret_cast<Four*>(step.moments.v.sh + start);
    Four p = *to_p, m = *to_m, v = *to_v;
    const float gradient[4] = {grad.x, grad.y, grad.z, grad.w};
    for (int k = 0; k < 4; ++k) {
      if (first + k >= step.adam.sh_active) break;
      StepNumbers<1>(gradient + k, ShRate(first + k), step.adam.correction2_root, {p.x + k, m.x + k, v.x + k});
    }
    *to_p = p;
    *to_m = m;
    *to_v = v;
  }

  /// Selects one of the two rates. Indexing by lane would read the constants once a lane.
  __device__ float ShRate(int k) const { return k < kColors ? step.adam.sh[0] : step.adam.sh[kColors]; }

  __device__ void StepHalfSh(int64_t i, int first, float4 grad) const {
    const int64_t start = i * kShFloats + first;
    Four* to_p = reinterpret_cast<Four*>(step.params.sh + start);
    FourHalves* to_m = reinterpret_cast<FourHalves*>(step.moments.sh_m + start);
    FourHalves* to_v = reinterpret_cast<FourHalves*>(step.moments.sh_v_half + start);
    Four p = *to_p;
    FourHalves m = *to_m, v = *to_v;
    const float gradient[4] = {grad.x, grad.y, grad.z, grad.w};
    const RoundingNoise<uint32_t> noise{kNoiseOfValue, kNoiseOfMoment, kNoiseMix, kNoiseShift, step.adam.noise};
    for (int k = 0; k < 4; ++k) {
      if (first + k >= step.adam.sh_active) break;
      AdamNumber<float> n{p.x[k], FromBfloat16(m.x[k]), FromBfloat16(v.x[k])};
      StepNumber(gradient[k], ShRate(first + k), step.adam.correction2_root, &n);
      p.x[k] = n.value, m.x[k] = ToBfloat16(n.m),
      v.x[k] = ToBfloat16AtRandom(n.v, noise(__float_as_uint(n.value), __float_as_uint(n.v)));
    }
    *to_p = p;
    *to_m = m;
    *to_v = v;
  }

  /// Steps four coefficients with compact moments. Runs after ConsumeSmall, which updates the moment that they share.
  __device__ void StepCompactSh(int64_t i, int first, float4 grad) const {
    const int64_t start = i * kShFloats + first;
    Four* to_p = reinterpret_cast<Four*>(step.params.sh + start);
    FourHalves* to_m = reinterpret_cast<FourHalves*>(step.moments.sh_m + start);
    Four p = *to_p;
    FourHalves m = *to_m;
    const float scale = 1 / RootOf(step.moments.sh_v[i], step.adam.correction2_root);
    const float gradient[4] = {grad.x, grad.y, grad.z, grad.w};
    for (int k = 0; k < 4; ++k) {
      if (first + k >= step.adam.sh_active) break;
      const float first_moment = NextFirstMoment(gradient[k], FromBfloat16(m.x[k]));
      m.x[k] = ToBfloat16(first_moment);
      p.x[k] -= ShRate(first + k) * scale * first_moment;
    }
    *to_p = p;
    *to_m = m;
  }
};

/// The gradients of parts are added to each of the view's before its step.
struct PartStepConsumer {
  StepConsumer consumer;

  __device__ void ConsumeSmall(int64_t i, const GaussianGrad& of_view) const {
    GaussianGrad grad = of_view;
    const StepConstants& step = consumer.step;
    for (int part = 0; part < step.parts; ++part) {
      const GaussianRows& rows = step.part_gradients[part];
      const SmallRow row = LoadRow(rows, i);
      for (int k = 0; k < 3; ++k) grad.mean[k] += row.mean[k];
      for (int k = 0; k < 3; ++k) grad.log_scale[k] += row.log_scale[k];
      for (int k = 0; k < 4; ++k) grad.quat[k] += row.quat[k];
      grad.logit += row.logit;
      for (int k = 0; k < kColors; ++k) grad.sh0[k] += rows.sh[i * kShFloats + k];
    }
    consumer.ConsumeSmall(i, grad);
  }

  /// Coefficients above the active degree have no gradient, and their rows hold anything.
  __device__ void ConsumeSh(int64_t i, int first, float4 grad) const {
    const StepConstants& step = consumer.step;
    float sums[4] = {grad.x, grad.y, grad.z, grad.w};
    for (int part = 0; part < step.parts; ++part) {
      const float* row = step.part_gradients[part].sh + i * kShFloats;
      for (int k = 0; k < 4; ++k) {
        if (first + k < step.adam.sh_active) sums[k] += row[first + k];
      }
    }
    consumer.ConsumeSh(i, first, make_float4(sums[0], sums[1], sums[2], sums[3]));
  }
};

/// Consumer of nothing.
struct IgnoringConsumer {
  __device__ void ConsumeSmall(int64_t, const GaussianGrad&) const {}
  __device__ void ConsumeSh(int64_t, int, float4) const {}
};

__global__ void AddNoiseToAll(NoiseInput in) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kStepBlock + threadIdx.x;
  if (i >= in.count) return;
  SmallRow row = LoadRow(in.params, i);
  MoveMean(in.noise, i, &row);
  for (int k = 0; k < 3; ++k) in.params.means[3 * i + k] = row.mean[k];
}

constexpr int kFactorsBlock = 256;

__global__ void DrawFactors(OpacityFactorsInput in) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kFactorsBlock + threadIdx.x;
  if (i >= in.count) return;
  const OpacityConstants constants{in.seed, static_cast<uint32_t>(in.iteration), static_cast<float>(in.drop),
                                   static_cast<float>(in.noise)};
  in.factors[i] = OpacityFactor<float>(constants, static_cast<uint32_t>(i));
}

}  // namespace

void RunRegularizerSums(const RegularizerInput& in, cudaStream_t stream) {
  Launch("the sums of the regularizers", SumRegularizers, LaunchShape::For(in.count, kStepBlock), stream, in);
}

void RunStep(const GaussianBackwardInput& in, const StepConstants& step) {
  constexpr const char* kName = "gradients of Gaussians and Adam";
  if (step.parts > 0) return RunGaussianBackward(kName, in, PartStepConsumer{{step}});
  RunGaussianBackward(kName, in, StepConsumer{step});
}

void RunWithoutStep(const GaussianBackwardInput& in) {
  RunGaussianBackward("gradients of Gaussians", in, IgnoringConsumer{});
}

void RunNoise(const NoiseInput& in, cudaStream_t stream) {
  Launch("noise", AddNoiseToAll, LaunchShape::For(in.count, kStepBlock), stream, in);
}

void RunOpacityFactors(const OpacityFactorsInput& in, cudaStream_t stream) {
  Launch("opacity factors", DrawFactors, LaunchShape::For(in.count, kFactorsBlock), stream, in);
}

}  // namespace oraclegs::cuda
