#pragma once
// Gaussians on the device of the tests.

#include "support/device_buffers.h"
#include "train/gaussian_fixtures.h"

namespace oraclegs {

inline Gaussians OnTestDevice(const Gaussians& gaussians) {
  Gaussians copy = gaussians;
  copy.ForEach([](const char*, Buffer<float>& t) { t = OnTestDevice(t); });
  return copy;
}

inline Gaussians OnHost(const Gaussians& gaussians) {
  Gaussians copy = gaussians;
  copy.ForEach([](const char*, Buffer<float>& t) { t = OnHost(t); });
  return copy;
}

/// |a - b| <= share * max |b| of each tensor.
inline void ExpectClose(const Gaussians& a, const Gaussians& b, double share) {
  const std::vector<Buffer<float>> x = Tensors(a), y = Tensors(b);
  const char* names[] = {"means", "log_scales", "quats", "opacity_logits", "sh"};
  for (size_t i = 0; i < x.size(); ++i) {
    ASSERT_EQ(x[i].shape(), y[i].shape()) << names[i];
    const Buffer<float> away = (x[i].to(torch::kDouble) - y[i].to(torch::kDouble)).abs();
    EXPECT_LE(away.max().item<double>(), share * y[i].abs().max().item<double>()) << names[i];
  }
}

}  // namespace oraclegs
