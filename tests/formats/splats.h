#pragma once
// Splats for the tests of the formats, and how far two of them are apart.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "oraclegs/core/statistics.h"
#include "oraclegs/formats/values.h"
#include "support/buffers.h"
#include "support/errors.h"

namespace oraclegs {

/// Gaussians like trained ones: of some size and opacity, with weak view-dependent color.
inline Gaussians PlausibleGaussians(int64_t n, uint64_t seed = 3) {
  Gaussians g = Gaussians::Empty(n);
  g.ForEach([&](const char*, Buffer<float>& t) { t = RandomNormal(t.shape(), seed++); });
  Flat(g.log_scales) = Flat(g.log_scales) * 0.7f - 4.f;
  Flat(g.opacity_logits) = Flat(g.opacity_logits) * 2.f;
  Table(g.sh).leftCols(3) *= 0.6f;
  Table(g.sh).rightCols(kShFloats - 3) *= 0.15f;
  return g;
}

/// Largest differences of drawn quantities: quaternions as rotations (q = -q), opacities and colors after activation.
struct SplatDistance {
  float means = 0, log_scales = 0, rotation = 0, opacity = 0, color = 0, first_degree = 0, higher_degrees = 0;
};

inline SplatDistance DistanceOf(const Gaussians& a, const Gaussians& b) {
  SplatDistance d;
  const auto raise = [](float* largest, float value) {
    *largest = value > *largest || std::isnan(value) ? value : *largest;
  };
  EXPECT_EQ(a.size(), b.size());
  for (int64_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    const GaussianRows x = a.Rows().From(i), y = b.Rows().From(i);
    const auto p = UnitQuaternion(x.quats), q = UnitQuaternion(y.quats);
    const float dot = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3];
    for (int c = 0; c < 4; ++c) raise(&d.rotation, std::abs(p[c] - std::copysign(1.f, dot) * q[c]));
    for (int c = 0; c < 3; ++c) {
      raise(&d.means, std::abs(x.means[c] - y.means[c]));
      raise(&d.log_scales, std::abs(x.log_scales[c] - y.log_scales[c]));
      raise(&d.color, std::abs(x.sh[c] - y.sh[c]) * static_cast<float>(kConstantSh));
    }
    raise(&d.opacity, std::abs(Sigmoid(x.opacity_logits[0]) - Sigmoid(y.opacity_logits[0])));
    for (int k = 3; k < kShFloats; ++k)
      raise(k < 12 ? &d.first_degree : &d.higher_degrees, std::abs(x.sh[k] - y.sh[k]));
  }
  return d;
}

/// The message of the InputError that decoding throws; it names the file "scene.x".
template <class Decode>
std::string DecodeError(Decode&& decode, const std::string& bytes) {
  const std::string message = MessageOf<InputError>([&] { decode(bytes, "scene.x"); });
  EXPECT_NE(message.find("scene.x"), std::string::npos) << message;
  return message;
}

}  // namespace oraclegs
