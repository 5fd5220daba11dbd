#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

Gaussians Gaussians::Empty(int64_t n) {
  const auto f32 = torch::TensorOptions().dtype(torch::kFloat);
  Gaussians g;
  g.means = torch::empty({n, 3}, f32);
  g.log_scales = torch::empty({n, 3}, f32);
  g.quats = torch::empty({n, 4}, f32);
  g.opacity_logits = torch::empty({n}, f32);
  g.sh = torch::empty({n, kShCoefficients, 3}, f32);
  return g;
}

Gaussians Gaussians::Zeros(int64_t n) {
  Gaussians g = Empty(n);
  g.ForEach([](const char*, Tensor& t) { t.zero_(); });
  return g;
}

void Gaussians::Check(const char* who) const {
  RequireFloat(who, "means", means, {-1, 3});
  const int64_t n = size();
  RequireFloat(who, "log_scales", log_scales, {n, 3});
  RequireFloat(who, "quats", quats, {n, 4});
  RequireFloat(who, "opacity_logits", opacity_logits, {n});
  RequireFloat(who, "sh", sh, {n, kShCoefficients, 3});
  ForEach([&](const char* name, const Tensor& t) {
    if (t.device() == means.device()) return;
    throw ShapeError("{}: {} is on {}, means on {}", who, name, t.device().str(), means.device().str());
  });
}

GaussianRows Gaussians::Rows() const {
  return {means.data_ptr<float>(), log_scales.data_ptr<float>(), quats.data_ptr<float>(),
          opacity_logits.data_ptr<float>(), sh.data_ptr<float>()};
}

}  // namespace oraclegs
