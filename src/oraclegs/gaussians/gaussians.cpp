#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

Gaussians Gaussians::Empty(int64_t n, Device device) {
  const auto rows = [&](const Shape& shape) { return Buffer<float>::Empty(shape, device, "Gaussians"); };
  return {rows({n, 3}), rows({n, 3}), rows({n, 4}), rows({n}), rows({n, kShCoefficients, 3})};
}

Gaussians Gaussians::Zeros(int64_t n, Device device) {
  Gaussians g = Empty(n, device);
  g.ForEach([](const char*, Buffer<float>& t) { t.SetZero(); });
  return g;
}

void Gaussians::Check(const char* who) const {
  RequireShape(who, "means", means, {-1, 3});
  const int64_t n = size();
  RequireShape(who, "log_scales", log_scales, {n, 3});
  RequireShape(who, "quats", quats, {n, 4});
  RequireShape(who, "opacity_logits", opacity_logits, {n});
  RequireShape(who, "sh", sh, {n, kShCoefficients, 3});
  ForEach([&](const char* name, const Buffer<float>& t) {
    if (t.device() == means.device()) return;
    throw ShapeError("{}: {} is on {}, means on {}", who, name, t.device().Name(), means.device().Name());
  });
}

GaussianRows Gaussians::Rows() const {
  return {means.data(), log_scales.data(), quats.data(), opacity_logits.data(), sh.data()};
}

Gaussians Gaussians::Clone() const {
  Gaussians copy = *this;
  copy.ForEach([](const char*, Buffer<float>& t) { t = t.Clone(); });
  return copy;
}

Gaussians Gaussians::To(Device device) const {
  Gaussians moved = *this;
  moved.ForEach([&](const char*, Buffer<float>& t) { t = t.To(device); });
  return moved;
}

void AddRows(const Gaussians& from, int64_t begin, int64_t end, int sh_floats, const GaussianRows& to) {
  const GaussianRows rows = from.Rows().From(begin);
  const auto add = [&](const float* source, float* sum, int64_t row) {
    for (int64_t i = 0; i < row * (end - begin); ++i) sum[i] += source[i];
  };
  add(rows.means, to.means, 3);
  add(rows.log_scales, to.log_scales, 3);
  add(rows.quats, to.quats, 4);
  add(rows.opacity_logits, to.opacity_logits, 1);
  for (int64_t i = 0; i < end - begin; ++i) {
    for (int k = 0; k < sh_floats; ++k) to.sh[kShFloats * i + k] += rows.sh[kShFloats * i + k];
  }
}

}  // namespace oraclegs
