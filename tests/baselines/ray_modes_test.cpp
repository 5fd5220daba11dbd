#include "oraclegs/baselines/ray_modes.h"

#include <cmath>

#include "oraclegs/render/render.h"
#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

/// Looks along z from the origin, 24 x 20 pixels.
Camera Straight() { return {24, 20, 20, 20, 12, 10, Eigen::Isometry3d::Identity()}; }

struct Disc {
  float x, y, z, scale, opacity;
};

Gaussians Discs(const std::vector<Disc>& discs) {
  Gaussians g = RandomGaussians(static_cast<int64_t>(discs.size()), 1);
  for (size_t i = 0; i < discs.size(); ++i) {
    const Disc& d = discs[i];
    const float mean[3] = {d.x, d.y, d.z};
    std::copy(mean, mean + 3, g.means.data() + 3 * i);
    std::fill_n(g.log_scales.data() + 3 * i, 3, std::log(d.scale));
    g.opacity_logits[static_cast<int64_t>(i)] = std::log(d.opacity / (1 - d.opacity));
  }
  return g;
}

constexpr int64_t kMiddle = 10 * 24 + 12;  // its center is half a pixel from the optical axis

TEST(RayView, ModeIsTheLargestWeight) {
  // So wide that the falloff is nearly 1: weights 0.3, 0.7 * 0.6 = 0.42, 0.28 * 0.9 = 0.252.
  const RayView view(Discs({{0, 0, 6, 9, 0.9f}, {0, 0, 2, 9, 0.3f}, {0, 0, 4, 9, 0.6f}}), Straight(), {});
  const RayModes modes = view.FindModes();
  EXPECT_EQ(modes.mode_depth[kMiddle], 4);
  EXPECT_NEAR(modes.blended_depth[kMiddle], (0.3 * 2 + 0.42 * 4 + 0.252 * 6) / 0.972, 1e-3);
  std::vector<uint8_t> marked(3, 0);
  view.MarkUpToMode(modes, kMiddle, -4, &marked);
  EXPECT_EQ(marked, (std::vector<uint8_t>{0, 1, 1}));
}

TEST(RayView, MarksWhatCoversThePixel) {
  // The second lies beside the pixel, three and a half standard deviations away: exp(-6.1) of its peak.
  const Gaussians g = Discs({{0, 0, 4, 0.2f, 0.8f}, {1.05f, 0, 3, 0.3f, 0.9f}, {0, 0, 2, 9, 0.1f}});
  const RayView view(g, Straight(), {});
  const RayModes modes = view.FindModes();
  const auto marked = [&](double min_log_falloff) {
    std::vector<uint8_t> all(3, 0);
    view.MarkUpToMode(modes, kMiddle, min_log_falloff, &all);
    return all;
  };
  EXPECT_EQ(modes.mode_depth[kMiddle], 4);
  EXPECT_EQ(marked(-4), (std::vector<uint8_t>{1, 0, 1}));
  EXPECT_EQ(marked(-9), (std::vector<uint8_t>{1, 1, 1}));
}

TEST(RayView, EmptyPixelsHaveNoMode) {
  const RayView view(Discs({{0, 0, 4, 0.05f, 0.8f}}), Straight(), {});
  const RayModes modes = view.FindModes();
  EXPECT_EQ(modes.mode_depth[0], 0);
  EXPECT_EQ(modes.blended_depth[0], 0);
  EXPECT_EQ(modes.mode_entry[0], -1);
  std::vector<uint8_t> marked(1, 0);
  view.MarkUpToMode(modes, 0, -4, &marked);
  EXPECT_EQ(marked[0], 0);
  EXPECT_EQ(modes.mode_depth[kMiddle], 4);
}

TEST(RayView, BlendsAsTheRasterizerDoes) {
  Gaussians g = RandomGaussians(400, 4);
  Table(g.means).col(2) += 4;
  const RayModes modes = RayView(g, Straight(), {}).FindModes();
  // Of Gaussians at one depth, the blended depth is that depth wherever the rasterizer shows anything.
  Gaussians flat = g.Clone();
  Table(flat.means).col(2).setConstant(4);
  const RayModes level = RayView(flat, Straight(), {}).FindModes();
  const auto rasterizer = MakeRasterizer(kCpu);
  const RenderOutput out = rasterizer->Forward(flat, Straight(), {}, RenderPass::kInference);
  for (int64_t i = 0; i < 24 * 20; ++i) {
    EXPECT_EQ(out.alpha[i] > 0, level.mode_entry[i] >= 0);
    if (level.mode_entry[i] >= 0) {
      EXPECT_NEAR(level.blended_depth[i], 4, 1e-4);
    }
    EXPECT_GE(modes.blended_depth[i], 0);
  }
}

TEST(RayView, SameForAnyNumberOfThreads) {
  Gaussians g = RandomGaussians(3000, 4);
  Table(g.means).col(2) += 4;
  const auto run = [&](int threads) {
    const Threads scope(threads);
    return RayView(g, Straight(), {}).FindModes();
  };
  const RayModes one = run(1), three = run(3);
  EXPECT_EQ(one.mode_depth, three.mode_depth);
  EXPECT_EQ(one.blended_depth, three.blended_depth);
  EXPECT_EQ(one.mode_entry, three.mode_entry);
}

}  // namespace
}  // namespace oraclegs
