// One pass over memory: a vector of each of gradient, parameter and both moments is read, the last three are written.
// Rows of sh are 48 floats apart, and a whole number of vectors, so that the coefficients above the active degree are
// left out a vector at a time; what of them shares a vector with active ones gets a zero gradient.

#include "oraclegs/train/adam.h"

#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/render/cpu/hwy_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "oraclegs/train/adam.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef ORACLEGS_TRAIN_ADAM_ONCE_
#define ORACLEGS_TRAIN_ADAM_ONCE_
namespace oraclegs {

inline constexpr double kBeta1 = 0.9, kBeta2 = 0.999;
inline constexpr double kAdamEpsilon = 1e-15;
inline constexpr int kShRow = kShCoefficients * 3;  // floats

/// One parameter tensor and what belongs to it.
struct AdamArrays {
  const float* g;
  float *p, *m, *v;
};

/// Learning rates of a row of sh.
struct ShRates {
  float rates[kShRow];
  int active;  ///< floats of a row that are trained
};

/// What of one step does not depend on the parameter.
struct AdamStep {
  float correction1;       ///< 1 / (1 - beta1^t)
  float correction2_root;  ///< 1 / sqrt(1 - beta2^t)
};

}  // namespace oraclegs
#endif

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;

/// One vector of one parameter. `rate` = learning rate * correction1.
HWY_INLINE void UpdateVector(V g, V rate, V correction2_root, const AdamArrays& a, int64_t at) {
  const D d;
  const V beta1 = hn::Set(d, static_cast<float>(kBeta1)), rest1 = hn::Set(d, static_cast<float>(1 - kBeta1));
  const V beta2 = hn::Set(d, static_cast<float>(kBeta2)), rest2 = hn::Set(d, static_cast<float>(1 - kBeta2));
  // Moments of a Gaussian that no view sees any more decay into the subnormal numbers and would stay there, which is
  // slow on many processors. Zero in their place moves no parameter: epsilon is far above.
  const V smallest = hn::Set(d, 1.17549435e-38f);
  V m = hn::MulAdd(beta1, hn::LoadU(d, a.m + at), hn::Mul(rest1, g));
  V v = hn::MulAdd(beta2, hn::LoadU(d, a.v + at), hn::Mul(rest2, hn::Mul(g, g)));
  m = hn::IfThenZeroElse(hn::Lt(hn::Abs(m), smallest), m);
  v = hn::IfThenZeroElse(hn::Lt(v, smallest), v);
  const V root = hn::MulAdd(hn::Sqrt(v), correction2_root, hn::Set(d, static_cast<float>(kAdamEpsilon)));
  const V p = hn::LoadU(d, a.p + at);
  hn::StoreU(m, d, a.m + at);
  hn::StoreU(v, d, a.v + at);
  hn::StoreU(hn::Sub(p, hn::Div(hn::Mul(rate, m), root)), d, a.p + at);
}

/// Floats [begin, end) of a tensor with one learning rate.
void UpdateFlat(const AdamArrays& a, int64_t begin, int64_t end, double learning_rate, const AdamStep& step) {
  const D d;
  const int64_t lanes = static_cast<int64_t>(hn::Lanes(d));
  const V rate = hn::Set(d, static_cast<float>(learning_rate) * step.correction1);
  const V root = hn::Set(d, step.correction2_root);
  int64_t at = begin;
  for (; at + lanes <= end; at += lanes) UpdateVector(hn::LoadU(d, a.g + at), rate, root, a, at);
  if (at == end) return;
  // The last few, in a vector of their own, so that they see the same arithmetic as the others.
  HWY_ALIGN float buffer[4][hn::MaxLanes(D())] = {};
  for (int64_t i = at; i < end; ++i) {
    buffer[0][i - at] = a.g[i], buffer[1][i - at] = a.p[i], buffer[2][i - at] = a.m[i], buffer[3][i - at] = a.v[i];
  }
  UpdateVector(hn::Load(d, buffer[0]), rate, root, {buffer[0], buffer[1], buffer[2], buffer[3]}, 0);
  for (int64_t i = at; i < end; ++i) {
    a.p[i] = buffer[1][i - at], a.m[i] = buffer[2][i - at], a.v[i] = buffer[3][i - at];
  }
}

/// Rows [begin, end) of sh, the first floats of each.
void UpdateSh(const AdamArrays& a, int64_t begin, int64_t end, const ShRates& sh, const AdamStep& step) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  static_assert(kShRow % hn::MaxLanes(D()) == 0, "a row must be whole vectors");
  const V root = hn::Set(d, step.correction2_root), correction1 = hn::Set(d, step.correction1);
  const int whole = sh.active / lanes * lanes;
  const auto partial = hn::FirstN(d, static_cast<size_t>(sh.active - whole));
  for (int64_t row = begin; row < end; ++row) {
    const int64_t start = row * kShRow;
    for (int k = 0; k < whole; k += lanes) {
      UpdateVector(hn::LoadU(d, a.g + start + k), hn::Mul(hn::LoadU(d, sh.rates + k), correction1), root, a, start + k);
    }
    if (whole == sh.active) continue;
    const V g = hn::IfThenElseZero(partial, hn::LoadU(d, a.g + start + whole));
    UpdateVector(g, hn::Mul(hn::LoadU(d, sh.rates + whole), correction1), root, a, start + whole);
  }
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace oraclegs {
namespace {

HWY_EXPORT(UpdateFlat);
HWY_EXPORT(UpdateSh);

constexpr int64_t kGrain = 4096;  // Gaussians; whole vectors of every tensor

/// A tensor with one learning rate.
struct FlatGroup {
  AdamArrays arrays;
  int64_t row;  ///< floats of a Gaussian
  double rate;
};

AdamArrays Arrays(const Tensor& g, const Tensor& p, const Tensor& m, const Tensor& v) {
  return {g.data_ptr<float>(), p.data_ptr<float>(), m.data_ptr<float>(), v.data_ptr<float>()};
}

void RequireSameSize(const char* name, const Gaussians& other, const Gaussians& params) {
  other.Check(name);
  if (other.size() != params.size()) {
    throw ShapeError("{}: {} Gaussians, expected {}", name, other.size(), params.size());
  }
}

}  // namespace

Adam::Adam(int64_t n) : m(Gaussians::Zeros(n)), v(Gaussians::Zeros(n)) {}

void Adam::Step(const Gaussians& grads, const LearningRates& rates, int sh_degree, Gaussians* params) {
  params->Check("Adam::Step params");
  RequireSameSize("Adam::Step grads", grads, *params);
  RequireSameSize("Adam::Step first moments", m, *params);
  RequireSameSize("Adam::Step second moments", v, *params);
  if (sh_degree < 0 || sh_degree > kMaxShDegree) throw ShapeError("Adam::Step: degree {}", sh_degree);

  ++step;
  const double t = static_cast<double>(step);
  const AdamStep constants{static_cast<float>(1 / (1 - std::pow(kBeta1, t))),
                           static_cast<float>(1 / std::sqrt(1 - std::pow(kBeta2, t)))};
  const FlatGroup flat[] = {
      {Arrays(grads.means, params->means, m.means, v.means), 3, rates.means},
      {Arrays(grads.log_scales, params->log_scales, m.log_scales, v.log_scales), 3, rates.log_scales},
      {Arrays(grads.quats, params->quats, m.quats, v.quats), 4, rates.quats},
      {Arrays(grads.opacity_logits, params->opacity_logits, m.opacity_logits, v.opacity_logits), 1,
       rates.opacity_logits},
  };
  const AdamArrays sh = Arrays(grads.sh, params->sh, m.sh, v.sh);
  ShRates sh_rates{{}, 3 * ShCount(sh_degree)};
  for (int k = 0; k < kShRow; ++k) sh_rates.rates[k] = static_cast<float>(k < 3 ? rates.sh0 : rates.sh_rest);
  ParallelBlocks(params->size(), kGrain, [&](int64_t begin, int64_t end) {
    for (const FlatGroup& group : flat) {
      HWY_DYNAMIC_DISPATCH(UpdateFlat)
      (group.arrays, begin * group.row, end * group.row, group.rate, constants);
    }
    HWY_DYNAMIC_DISPATCH(UpdateSh)(sh, begin, end, sh_rates, constants);
  });
}

}  // namespace oraclegs
#endif
