#pragma once
// Gaussians on the device of the tests.

#include "render/cuda/device_scenes.h"
#include "train/gaussian_fixtures.h"

namespace oraclegs {

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
