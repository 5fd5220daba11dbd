#pragma once
// One Gaussian's step. Its colours are moved apart from the rest, four neighbouring coefficients at a time: rows of sh
// are 192 bytes, hence aligned to 16.

#include "oraclegs/train/cuda/noise-inl.cuh"

namespace oraclegs::cuda {

/// One number. rate: learning rate / (1 - beta1^t).
__device__ inline void AdamNumber(float g, float rate, float correction2_root, float* p, float* m, float* v) {
  constexpr float kBeta1 = static_cast<float>(kAdamBeta1), kRest1 = static_cast<float>(1 - kAdamBeta1);
  constexpr float kBeta2 = static_cast<float>(kAdamBeta2), kRest2 = static_cast<float>(1 - kAdamBeta2);
  float first = kBeta1 * *m + kRest1 * g, second = kBeta2 * *v + kRest2 * (g * g);
  if ((first < 0 ? -first : first) < kSmallestMoment) first = 0;
  if (second < kSmallestMoment) second = 0;
  *p -= rate * first / (std::sqrt(second) * correction2_root + static_cast<float>(kAdamEpsilon));
  *m = first;
  *v = second;
}

__device__ inline void AdamRow(const AdamConstants& adam, const SplatRow& g, SplatRow* p, SplatRow* m, SplatRow* v) {
  const float root = adam.correction2_root;
  for (int k = 0; k < 3; ++k) AdamNumber(g.mean[k], adam.means, root, &p->mean[k], &m->mean[k], &v->mean[k]);
  for (int k = 0; k < 3; ++k) {
    AdamNumber(g.log_scale[k], adam.log_scales, root, &p->log_scale[k], &m->log_scale[k], &v->log_scale[k]);
  }
  for (int k = 0; k < 4; ++k) AdamNumber(g.quat[k], adam.quats, root, &p->quat[k], &m->quat[k], &v->quat[k]);
  AdamNumber(g.logit, adam.opacity_logits, root, &p->logit, &m->logit, &v->logit);
}

/// Regularisers, Adam and noise of row i, all but its colours; g: its gradient.
__device__ inline void MoveSplat(const StepConstants& step, int64_t i, SplatRow g) {
  SplatRow p = LoadRow(step.params, i), m = LoadRow(step.m, i), v = LoadRow(step.v, i);
  const float opacity = Sigmoid(p.logit);
  g.logit += step.regularizers.opacity * (opacity * (1 - opacity));
  for (int k = 0; k < 3; ++k) g.log_scale[k] += step.regularizers.scale * ExpClamped(p.log_scale[k]);
  AdamRow(step.adam, g, &p, &m, &v);
  StoreRow(m, step.m, i);
  StoreRow(v, step.v, i);
  if (step.adds_noise) AddNoiseTo(step.noise, static_cast<uint32_t>(step.first + i), &p);
  StoreRow(p, step.params, i);
}

struct alignas(16) Four {
  float x[4];
};

/// Adam of floats [first, first + 4) of row i of sh. Coefficients above the active degree have neither gradient nor
/// moments: they are left alone.
__device__ inline void MoveColor(const StepConstants& step, int64_t i, int first, const Four& g) {
  const int64_t start = i * kShFloats + first;
  Four* to_p = reinterpret_cast<Four*>(step.params.sh + start);
  Four* to_m = reinterpret_cast<Four*>(step.m.sh + start);
  Four* to_v = reinterpret_cast<Four*>(step.v.sh + start);
  Four p = *to_p, m = *to_m, v = *to_v;
  for (int k = 0; k < 4; ++k) {
    if (first + k >= step.adam.sh_active) break;
    AdamNumber(g.x[k], step.adam.sh[first + k], step.adam.correction2_root, &p.x[k], &m.x[k], &v.x[k]);
  }
  *to_p = p;
  *to_m = m;
  *to_v = v;
}

}  // namespace oraclegs::cuda
