#pragma once
// Gaussians on the device of the tests.

#include "support/device_buffers.h"
#include "train/gaussian_fixtures.h"

namespace oraclegs {

inline Gaussians OnTestDevice(const Gaussians& g) {
  Gaussians out = g;
  out.ForEach([](const char*, Buffer<float>& t) { t = OnTestDevice(t); });
  return out;
}

inline Gaussians OnHost(const Gaussians& gaussians) { return gaussians.To(kCpu); }

/// |a - b| <= share * max |b| of each parameter.
inline void ExpectClose(const Gaussians& a, const Gaussians& b, double share) {
  const std::vector<Buffer<float>> x = Tensors(a), y = Tensors(b);
  const char* names[] = {"means", "log_scales", "quats", "opacity_logits", "sh"};
  for (size_t i = 0; i < x.size(); ++i) {
    ASSERT_EQ(x[i].shape(), y[i].shape()) << names[i];
    EXPECT_LE(MaxAbsError(x[i], y[i]), share * static_cast<double>(MaxAbs(y[i]))) << names[i];
  }
}

}  // namespace oraclegs
