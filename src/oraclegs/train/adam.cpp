// One pass over memory: each vector of gradient, parameter and both moments is read, the last three are written.
// Rows of sh are 48 floats apart, a whole number of vectors, so that coefficients above the active degree are skipped a
// vector at a time; those that share a vector with active ones get a zero gradient.

#include "oraclegs/train/adam.h"

#include <cmath>

#include "oraclegs/core/hwy_targets.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/train/constants.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "oraclegs/train/adam.cpp"
// clang-format off: foreach_target must come before the other Highway headers
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "oraclegs/core/simd/bfloat16-inl.h"
#include "oraclegs/core/simd/lanes-inl.h"
// After the lanes, whose functions it calls.
#include "oraclegs/train/step_math-inl.h"

#ifndef ORACLEGS_TRAIN_ADAM_ONCE_
#define ORACLEGS_TRAIN_ADAM_ONCE_
namespace oraclegs {

inline constexpr int kPrefetchRows = 8;  // of sh, ahead of use

/// One parameter array, or a part of it, with its gradients and moments.
struct AdamArrays {
  const float* g;
  float *p, *m, *v;
};

/// Gradients, parameters and moments of neighboring Gaussians.
struct AdamRows {
  GaussianRows gradients, params;
  MomentRows moments;
};

}  // namespace oraclegs
#endif

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

/// One vector of one parameter. `rate` = learning rate * correction1.
HWY_INLINE void UpdateVector(Lanes g, Lanes rate, Lanes correction2_root, const AdamArrays& a, int64_t at) {
  const FloatTag d;
  AdamNumber<Lanes> n{hn::LoadU(d, a.p + at), hn::LoadU(d, a.m + at), hn::LoadU(d, a.v + at)};
  StepNumber(g, rate, correction2_root, &n);
  hn::StoreU(n.m.v, d, a.m + at);
  hn::StoreU(n.v.v, d, a.v + at);
  hn::StoreU(n.value.v, d, a.p + at);
}

/// `count` floats with one learning rate.
HWY_INLINE void UpdateFlat(const AdamArrays& a, int64_t count, float scaled_rate, Lanes correction2_root) {
  const FloatTag d;
  const Lanes rate(scaled_rate);
  int64_t at = 0;
  for (; at + kLanes <= count; at += kLanes) UpdateVector(hn::LoadU(d, a.g + at), rate, correction2_root, a, at);
  if (at == count) return;
  // The remainder, in a vector of its own, so that it sees the same arithmetic as the others.
  HWY_ALIGN float buffer[4][kLanes] = {};
  for (int64_t i = at; i < count; ++i) {
    buffer[0][i - at] = a.g[i], buffer[1][i - at] = a.p[i], buffer[2][i - at] = a.m[i], buffer[3][i - at] = a.v[i];
  }
  UpdateVector(hn::Load(d, buffer[0]), rate, correction2_root, {buffer[0], buffer[1], buffer[2], buffer[3]}, 0);
  for (int64_t i = at; i < count; ++i) {
    a.p[i] = buffer[1][i - at], a.m[i] = buffer[2][i - at], a.v[i] = buffer[3][i - at];
  }
}

/// Prefetches the moments. They were last touched in the iteration before, so they come from main memory, in blocks too
/// short for the processor's prefetcher.
template <class T>
HWY_INLINE void PrefetchRow(const T* row) {
  constexpr int kCacheLine = 64 / sizeof(T);
  for (int k = 0; k < kShFloats; k += kCacheLine) hwy::Prefetch(row + k);
}

/// `count` rows of sh, the first floats of each.
HWY_INLINE void UpdateSh(const AdamArrays& a, int64_t count, const AdamConstants& constants, Lanes correction2_root) {
  const FloatTag d;
  static_assert(kShFloats % kLanes == 0, "a row must be whole vectors");
  const int whole = constants.sh_active / kLanes * kLanes;
  const auto partial = hn::FirstN(d, static_cast<size_t>(constants.sh_active - whole));
  for (int64_t row = 0; row < count; ++row) {
    const int64_t start = row * kShFloats;
    PrefetchRow(a.m + start + kPrefetchRows * kShFloats);
    PrefetchRow(a.v + start + kPrefetchRows * kShFloats);
    for (int k = 0; k < whole; k += kLanes) {
      UpdateVector(hn::LoadU(d, a.g + start + k), hn::LoadU(d, constants.sh + k), correction2_root, a, start + k);
    }
    if (whole == constants.sh_active) continue;
    const Lanes g = hn::IfThenElseZero(partial, hn::LoadU(d, a.g + start + whole));
    UpdateVector(g, hn::LoadU(d, constants.sh + whole), correction2_root, a, start + whole);
  }
}

/// UpdateSh for half moments.
HWY_INLINE void UpdateShHalf(const AdamRows& rows, int64_t count, const AdamConstants& constants) {
  const FloatTag d;
  const hn::RebindToUnsigned<FloatTag> bits;
  const Lanes root(constants.correction2_root);
  const RoundingNoise<decltype(hn::Zero(bits))> noise{hn::Set(bits, kNoiseOfValue), hn::Set(bits, kNoiseOfMoment),
                                                      hn::Set(bits, kNoiseMix), hn::Set(bits, kNoiseShift),
                                                      hn::Set(bits, constants.noise)};
  for (int64_t row = 0; row < count; ++row) {
    const float* g = rows.gradients.sh + row * kShFloats;
    float* p = rows.params.sh + row * kShFloats;
    uint16_t* m = rows.moments.sh_m + row * kShFloats;
    uint16_t* v = rows.moments.sh_v_half + row * kShFloats;
    PrefetchRow(m + kPrefetchRows * kShFloats);
    PrefetchRow(v + kPrefetchRows * kShFloats);
    for (int k = 0; k < constants.sh_active; k += kLanes) {
      const auto active = hn::FirstN(d, static_cast<size_t>(constants.sh_active - k));
      const Lanes gradient(hn::IfThenElseZero(active, hn::LoadU(d, g + k)));
      AdamNumber<Lanes> n{hn::LoadU(d, p + k), LoadBfloat16(m + k), LoadBfloat16(v + k)};
      StepNumber(gradient, Lanes(hn::LoadU(d, constants.sh + k)), root, &n);
      StoreBfloat16(n.m, m + k);
      StoreBfloat16AtRandom(n.v, noise(hn::BitCast(bits, n.value.v), hn::BitCast(bits, n.v.v)), v + k);
      hn::StoreU(n.value.v, d, p + k);
    }
  }
}

/// UpdateSh for compact moments.
HWY_INLINE void UpdateShCompact(const AdamRows& rows, int64_t count, const AdamConstants& constants) {
  const FloatTag d;
  for (int64_t row = 0; row < count; ++row) {
    const float* g = rows.gradients.sh + row * kShFloats;
    float* p = rows.params.sh + row * kShFloats;
    uint16_t* m = rows.moments.sh_m + row * kShFloats;
    float* v = rows.moments.sh_v + row;
    PrefetchRow(m + kPrefetchRows * kShFloats);
    *v = NextSecondMoment(MeanShSquare(g[0], g[1], g[2]), *v);
    const Lanes scale(1 / RootOf(*v, constants.correction2_root));
    for (int k = 0; k < constants.sh_active; k += kLanes) {
      const auto active = hn::FirstN(d, static_cast<size_t>(constants.sh_active - k));
      const Lanes gradient(hn::IfThenElseZero(active, hn::LoadU(d, g + k)));
      const Lanes first = NextFirstMoment(gradient, LoadBfloat16(m + k));
      const Lanes rate(hn::LoadU(d, constants.sh + k));
      StoreBfloat16(first, m + k);
      hn::StoreU((Lanes(hn::LoadU(d, p + k)) - rate * scale * first).v, d, p + k);
    }
  }
}

void UpdateGroup(const AdamArrays& arrays, int64_t count, float scaled_rate, float correction2_root) {
  UpdateFlat(arrays, count, scaled_rate, Lanes(correction2_root));
}

void UpdateRows(const AdamRows& rows, int64_t count, const AdamConstants& constants) {
  const auto& [g, p, moments] = rows;
  const GaussianRows &m = moments.m, &v = moments.v;
  const Lanes root(constants.correction2_root);
  UpdateFlat({g.means, p.means, m.means, v.means}, 3 * count, constants.means, root);
  UpdateFlat({g.log_scales, p.log_scales, m.log_scales, v.log_scales}, 3 * count, constants.log_scales, root);
  UpdateFlat({g.quats, p.quats, m.quats, v.quats}, 4 * count, constants.quats, root);
  UpdateFlat({g.opacity_logits, p.opacity_logits, m.opacity_logits, v.opacity_logits}, count, constants.opacity_logits,
             root);
  if (moments.half()) {
    UpdateShHalf(rows, count, constants);
  } else if (moments.compact()) {
    UpdateShCompact(rows, count, constants);
  } else {
    UpdateSh({g.sh, p.sh, m.sh, v.sh}, count, constants, root);
  }
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace oraclegs {
namespace {

HWY_EXPORT(UpdateRows);
HWY_EXPORT(UpdateGroup);

constexpr int64_t kAdamGrain = 4096;   // Gaussians; whole vectors of every tensor
constexpr int64_t kGroupGrain = 8192;  // floats

void RequireSameSize(const char* name, const Gaussians& other, const Gaussians& params) {
  other.Check(name);
  if (other.size() != params.size()) {
    throw ShapeError("{}: {} Gaussians, expected {}", name, other.size(), params.size());
  }
}

AdamConstants Constants(int64_t step, const LearningRates& rates, int sh_degree) {
  const double t = static_cast<double>(step);
  const float correction1 = static_cast<float>(1 / (1 - std::pow(kAdamBeta1, t)));
  const auto scaled = [&](double rate) { return static_cast<float>(rate) * correction1; };
  AdamConstants c{};
  c.correction2_root = static_cast<float>(1 / std::sqrt(1 - std::pow(kAdamBeta2, t)));
  c.means = scaled(rates.means);
  c.log_scales = scaled(rates.log_scales);
  c.quats = scaled(rates.quats);
  c.opacity_logits = scaled(rates.opacity_logits);
  for (int k = 0; k < kShFloats; ++k) c.sh[k] = scaled(k < 3 ? rates.sh0 : rates.sh_rest);
  c.sh_active = 3 * ShCount(sh_degree);
  c.noise = static_cast<uint32_t>(step) * kNoiseOfStep;
  return c;
}

}  // namespace

void AdamStep::Update(int64_t begin, int64_t end, const GaussianRows& grads) const {
  HWY_DYNAMIC_DISPATCH(UpdateRows)
  ({grads, params_.From(begin), moments_.From(begin)}, end - begin, constants_);
}

Adam::Adam(int64_t n, ShMoments sh_moments) : m(Gaussians::Zeros(n)), v(Gaussians::Zeros(n)) {
  if (sh_moments == ShMoments::kFull) return;
  const auto zeros = [n] { return Buffer<uint16_t>::Zeros({n, kShCoefficients, 3}); };
  m.sh = v.sh = {};
  sh_m = zeros();
  if (sh_moments == ShMoments::kHalf) {
    sh_v_half = zeros();
  } else {
    sh_v = Buffer<float>::Zeros({n});
  }
}

void Adam::Check(const char* who, int64_t n) const {
  for (const Gaussians* moment : {&m, &v}) {
    RequireShape(who, "the moments' means", moment->means, {n, 3});
    RequireShape(who, "the moments' log_scales", moment->log_scales, {n, 3});
    RequireShape(who, "the moments' quats", moment->quats, {n, 4});
    RequireShape(who, "the moments' opacity_logits", moment->opacity_logits, {n});
    if (sh_moments() == ShMoments::kFull) RequireShape(who, "the moments' sh", moment->sh, {n, kShCoefficients, 3});
  }
  if (sh_moments() == ShMoments::kFull) return;
  RequireShape(who, "the first moments' sh", sh_m, {n, kShCoefficients, 3});
  if (sh_moments() == ShMoments::kHalf) {
    RequireShape(who, "the second moments' sh", sh_v_half, {n, kShCoefficients, 3});
  } else {
    RequireShape(who, "the second moments' sh", sh_v, {n});
  }
}

Adam Adam::Clone() const {
  Adam copy = *this;
  copy.ForEachMoment([](const char*, const char*, auto& buffer) { buffer = buffer.Clone(); });
  return copy;
}

void Adam::GrowTo(int64_t n) {
  const int64_t had = size();
  ForEachMoment([&](const char*, const char*, auto& buffer) {
    buffer = buffer.GrownTo(n);
    buffer.Rows(had, n).SetZero();
  });
}

MomentRows Adam::Rows() const { return {m.Rows(), v.Rows(), sh_m.data(), sh_v_half.data(), sh_v.data()}; }

AdamConstants Adam::BeginStep(const LearningRates& rates, int sh_degree, const Gaussians& params) {
  params.Check("Adam::BeginStep params");
  Check("Adam::BeginStep", params.size());
  if (sh_degree < 0 || sh_degree > kMaxShDegree) throw ShapeError("Adam::BeginStep: degree {}", sh_degree);
  ++step;
  return Constants(step, rates, sh_degree);
}

AdamStep Adam::BeginStep(const LearningRates& rates, int sh_degree, Gaussians* params) {
  const AdamConstants constants = BeginStep(rates, sh_degree, static_cast<const Gaussians&>(*params));
  return {constants, params->Rows(), Rows()};
}

void Adam::Step(const Gaussians& grads, const LearningRates& rates, int sh_degree, Gaussians* params) {
  RequireSameSize("Adam::Step grads", grads, *params);
  const AdamStep begun = BeginStep(rates, sh_degree, params);
  const GaussianRows rows = grads.Rows();
  ParallelBlocks(params->size(), kAdamGrain,
                 [&](int64_t begin, int64_t end) { begun.Update(begin, end, rows.From(begin)); });
}

void Adam::StepGroup(Buffer<float> Gaussians::*group, const Gaussians& grads, double rate, Gaussians* params) {
  params->Check("Adam::StepGroup params");
  RequireSameSize("Adam::StepGroup grads", grads, *params);
  Check("Adam::StepGroup", params->size());
  LearningRates rates;
  rates.means = rate;
  const AdamConstants constants = Constants(step + 1, rates, 0);
  // On a GPU these are copies: a group is small beside the render that its gradients come from.
  const Buffer<float> g = (grads.*group).To(kCpu), values = (params->*group).To(kCpu), first = (m.*group).To(kCpu),
                      second = (v.*group).To(kCpu);
  const AdamArrays all{g.data(), values.data(), first.data(), second.data()};
  ParallelBlocks(values.count(), kGroupGrain, [&](int64_t begin, int64_t end) {
    HWY_DYNAMIC_DISPATCH(UpdateGroup)
    ({all.g + begin, all.p + begin, all.m + begin, all.v + begin}, end - begin, constants.means,
     constants.correction2_root);
  });
  if (params->device().is_cpu()) return;
  (params->*group).CopyFrom(values);
  (m.*group).CopyFrom(first);
  (v.*group).CopyFrom(second);
}

}  // namespace oraclegs
#endif
