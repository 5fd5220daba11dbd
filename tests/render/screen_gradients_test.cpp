#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/render/render.h"
#include "support/buffers.h"

namespace oraclegs {
namespace {

/// One Gaussian before a camera, and another behind it.
Gaussians OneInSight() {
  Gaussians g = Gaussians::Zeros(2);
  g.means[0] = 0.2f, g.means[1] = -0.1f, g.means[2] = 3;
  g.means[5] = -3;
  Flat(g.log_scales).setConstant(-1.5f);
  g.quats[0] = g.quats[4] = 1;
  g.sh[0] = 1, g.sh[1] = 0.5f;
  return g;
}

/// dL/d(image).
Buffer<float> Ramp() {
  const Buffer<float> ramp = Buffer<float>::Zeros({32, 48, 3});
  for (int64_t y = 0; y < 32; ++y) {
    for (int64_t x = 0; x < 48; ++x)
      ramp[3 * (48 * y + x)] = 0.1f * static_cast<float>(x) - 0.04f * static_cast<float>(y);
  }
  return ramp;
}

Camera CameraAt(double cx, double cy) { return {48, 32, 50, 50, cx, cy, Eigen::Isometry3d::Identity()}; }

TEST(ScreenGradients, AreThoseOfTheCenterInTheImage) {
  const Gaussians g = OneInSight();
  const Buffer<float> weights = Ramp();
  auto rasterizer = MakeRasterizer(kCpu);
  // To move the principal point is to move the center of the one Gaussian in sight.
  const auto loss = [&](double dx, double dy) {
    const Buffer<float> image = rasterizer->Forward(g, CameraAt(24 + dx, 16 + dy), {}, RenderPass::kInference).image;
    return (Wide(image) * Wide(weights)).sum();
  };
  const double h = 1e-3;  // small: pixels at the rim, where the Gaussian ends, must not come and go
  const double gx = (loss(h, 0) - loss(-h, 0)) / (2 * h) * 24, gy = (loss(0, h) - loss(0, -h)) / (2 * h) * 16;

  const ScreenGradients watched{Buffer<float>::Zeros({2}), Buffer<float>::Zeros({2})};
  Gaussians grads = Gaussians::Zeros(2);
  rasterizer->WatchScreen(&watched);
  for (int pass = 0; pass < 2; ++pass) {
    rasterizer->Forward(g, CameraAt(24, 16), {}, RenderPass::kTrain);
    rasterizer->Backward(g, {weights, {}, {}}, &grads);
  }
  const double wanted = 2 * std::hypot(gx, gy);
  EXPECT_NEAR(watched.sum[0], wanted, 0.01 * wanted);
  EXPECT_EQ(watched.views[0], 2);
  EXPECT_EQ(watched.sum[1], 0);
  EXPECT_EQ(watched.views[1], 0);

  rasterizer->WatchScreen(nullptr);
  rasterizer->Forward(g, CameraAt(24, 16), {}, RenderPass::kTrain);
  rasterizer->Backward(g, {weights, {}, {}}, &grads);
  EXPECT_EQ(watched.views[0], 2);
}

TEST(ScreenGradients, MustBeOfAsManyGaussians) {
  const Gaussians g = OneInSight();
  auto rasterizer = MakeRasterizer(kCpu);
  const ScreenGradients watched{Buffer<float>::Zeros({3}), Buffer<float>::Zeros({3})};
  Gaussians grads = Gaussians::Zeros(2);
  rasterizer->WatchScreen(&watched);
  rasterizer->Forward(g, CameraAt(24, 16), {}, RenderPass::kTrain);
  EXPECT_THROW(rasterizer->Backward(g, {Ramp(), {}, {}}, &grads), ShapeError);
}

}  // namespace
}  // namespace oraclegs
