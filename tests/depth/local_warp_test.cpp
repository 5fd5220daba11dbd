#include "oraclegs/depth/local_warp.h"

#include <gtest/gtest.h>

#include <cmath>

namespace oraclegs {
namespace {

constexpr int kMapWidth = 120, kMapHeight = 90;

/// Two surfaces that cross the image in stripes.
float Guess(int x, int y) { return (x / 6 + y / 9) % 2 == 0 ? 0.3f + 0.001f * static_cast<float>(x) : 0.8f; }

/// True inverse depth: the guess times a factor plus an addend that vary over the image by tens of percent.
float TrueDepth(int x, int y) {
  const float u = static_cast<float>(x) / kMapWidth, v = static_cast<float>(y) / kMapHeight;
  return (1.1f + 0.25f * std::sin(4 * u)) * Guess(x, y) + 0.08f * v - 0.05f * u;
}

std::vector<DepthSample> Samples(int step) {
  std::vector<DepthSample> samples;
  for (int y = 0; y < kMapHeight; y += step) {
    for (int x = 0; x < kMapWidth; x += step) {
      samples.push_back({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, Guess(x, y), TrueDepth(x, y), 1});
    }
  }
  return samples;
}

/// The mean relative error over the image.
double Error(const LocalWarp& warp) {
  double sum = 0;
  int n = 0;
  for (int y = 0; y < kMapHeight; ++y) {
    for (int x = 0; x < kMapWidth; ++x, ++n) {
      const float w = warp(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, Guess(x, y));
      sum += std::abs(static_cast<double>(w / TrueDepth(x, y)) - 1);
    }
  }
  return sum / n;
}

TEST(LocalWarp, IsIdentityWithoutSamples) {
  const LocalWarp none(kMapWidth, kMapHeight, {});
  EXPECT_EQ(none(3, 80, 0.7f), 0.7f);
  const LocalWarp unweighted(kMapWidth, kMapHeight, {{3, 3, 0.5f, 0.9f, 0}});
  EXPECT_EQ(unweighted(3, 3, 0.5f), 0.5f);
  EXPECT_GT(Error(none), 0.15);
}

TEST(LocalWarp, CorrectsVaryingScaleAndOffset) { EXPECT_LT(Error(LocalWarp(kMapWidth, kMapHeight, Samples(2))), 0.01); }

TEST(LocalWarp, IgnoresOutliers) {
  std::vector<DepthSample> samples = Samples(2);
  for (size_t i = 0; i < samples.size(); i += 5) samples[i].truth *= i % 2 == 0 ? 3.f : 0.3f;
  EXPECT_LT(Error(LocalWarp(kMapWidth, kMapHeight, samples)), 0.02);
}

TEST(LocalWarp, ExtrapolatesFromNeighbors) {
  std::vector<DepthSample> samples = Samples(2);
  std::erase_if(samples, [](const DepthSample& s) { return s.x > 0.75f * kMapWidth; });
  for (DepthSample& s : samples) s.truth = 1.3f * s.inv_depth;
  const LocalWarp warp(kMapWidth, kMapHeight, samples);
  for (int x = 90; x < kMapWidth; ++x) {
    const float w = warp(static_cast<float>(x) + 0.5f, 40.5f, Guess(x, 40));
    EXPECT_NEAR(w / (1.3f * Guess(x, 40)), 1, 0.08) << x << ": unbent it is off by a quarter";
  }
}

TEST(LocalWarp, IsInvariantToUnit) {
  std::vector<DepthSample> samples = Samples(3);
  const LocalWarp one(kMapWidth, kMapHeight, samples);
  for (DepthSample& s : samples) s.inv_depth *= 1000, s.truth *= 1000;
  const LocalWarp other(kMapWidth, kMapHeight, samples);
  for (int x = 0; x < kMapWidth; x += 7) {
    const auto u = static_cast<float>(x);
    EXPECT_NEAR(other(u, 40, 500.f) / 1000, one(u, 40, 0.5f), 1e-4);
  }
}

TEST(LocalWarp, AcceptsAnyImageShape) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{3, 200}, std::pair{17, 5}}) {
    const LocalWarp warp(width, height, {{0.5f, 0.5f, 0.5f, 0.6f, 1}});
    EXPECT_NEAR(warp(0.5f, 0.5f, 0.5f), 0.6, 0.03) << width << " x " << height;
    EXPECT_TRUE(std::isfinite(warp(static_cast<float>(width), static_cast<float>(height), 0.5f)));
  }
}

}  // namespace
}  // namespace oraclegs
