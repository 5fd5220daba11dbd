#include <hwy/aligned_allocator.h>

#include <vector>

#include "render/cpu/every_target.h"
#include "render/cpu/splats.h"
#include "support/golden.h"

namespace oraclegs {
namespace {

class BlendTileBackward : public EveryTarget {};

TEST_P(BlendTileBackward, RecordsAreTheMomentsOfTheFormula) {
  // Two splats over a background; upstream gradients on all three planes. Reference: spec 6.1, per pixel in double.
  const double first_cov[3] = {30, 8, 20}, second_cov[3] = {60, -10, 40};
  const std::vector<cpu::Splat> splats = {MakeSplat(21, 26, first_cov, 0.7, 2), MakeSplat(27, 22, second_cov, 0.6, 5)};
  const std::vector<cpu::TileEntry> entries = {{0, 0xffff, 0}, {1, 0xffff, 1}};
  const int size = 32;  // the tile (1, 1) of a 2 x 2 tile image
  std::vector<float> image(3 * size * size), alpha(size * size), inv_depth(size * size), transmittance(4 * 256);
  std::vector<uint32_t> end(4 * 256);
  const cpu::BlendImage planes{
      size, size, {0.2f, 0.3f, 0.4f}, image.data(), alpha.data(), inv_depth.data(), transmittance.data(), end.data()};
  cpu::BlendTile({splats.data(), entries.data(), 2, 0, 1, 1, 3}, planes);

  Rng rng(1, RandomStream::kInitialPoints);
  std::vector<float> up_image(3 * size * size), up_alpha(size * size), up_depth(size * size);
  for (auto* plane : {&up_image, &up_alpha, &up_depth}) {
    for (float& v : *plane) v = static_cast<float>(rng.Uniform(-1, 1));
  }
  auto records = hwy::AllocateAligned<float>(2 * cpu::kGradStride);
  cpu::BlendTileBackward({splats.data(), entries.data(), 2, 0, 1, 1, 3}, planes,
                         {up_image.data(), up_alpha.data(), up_depth.data()}, records.get());

  double expected[2][12] = {};
  for (int y = 16; y < 32; ++y) {
    for (int x = 16; x < 32; ++x) {
      const float* g = &up_image[3 * (size * y + x)];
      const double g_alpha = up_alpha[size * y + x], g_depth = up_depth[size * y + x];
      double a[2], t = 1, in_front[2], value[2];
      for (int i = 0; i < 2; ++i) {
        a[i] = AlphaAt(splats[i], x + 0.5, y + 0.5);
        if (a[i] < 1.0 / 255) a[i] = 0;
        in_front[i] = t;
        t *= 1 - a[i];
        value[i] = g[0] * splats[i].r + g[1] * splats[i].g + g[2] * splats[i].b + g_depth * splats[i].inv_z;
      }
      const double tail = g_alpha - (g[0] * 0.2 + g[1] * 0.3 + g[2] * 0.4);
      const double behind[2] = {a[1] * value[1], 0};
      for (int i = 0; i < 2; ++i) {
        const double g_a = in_front[i] * (value[i] - behind[i]) + t / (1 - a[i]) * tail;
        const double h = a[i] * g_a, w = a[i] * in_front[i], px = x + 0.5 - 24, py = y + 0.5 - 24;
        const double terms[12] = {h, h * px, h * py,   h * px * px, h * px * py, h * py * py,
                                  0, 0,      w * g[0], w * g[1],    w * g[2],    w * g_depth};
        for (int k = 0; k < 12; ++k) expected[i][k] += terms[k];
      }
    }
  }
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 12; ++k) {
      EXPECT_NEAR(records[i * cpu::kGradStride + k], expected[i][k], 2e-4 * (1 + std::abs(expected[i][k])))
          << i << ' ' << k;
    }
  }
}

TEST_P(BlendTileBackward, TheCapStopsTheFalloffButNotTheColour) {
  const double wide[3] = {1e8, 0, 1e8};
  const std::vector<cpu::Splat> splats = {MakeSplat(8, 8, wide, 0.999)};
  const std::vector<cpu::TileEntry> entries = {{0, 0xffff, 0}};
  std::vector<float> image(3 * 256), alpha(256), inv_depth(256), transmittance(256), up(3 * 256, 1.f);
  std::vector<uint32_t> end(256);
  const cpu::BlendImage planes{
      16, 16, {0, 0, 0}, image.data(), alpha.data(), inv_depth.data(), transmittance.data(), end.data()};
  cpu::BlendTile({splats.data(), entries.data(), 1, 0, 0, 0, 0}, planes);
  auto records = hwy::AllocateAligned<float>(cpu::kGradStride);
  cpu::BlendTileBackward({splats.data(), entries.data(), 1, 0, 0, 0, 0}, planes, {up.data(), nullptr, nullptr},
                         records.get());
  for (int k = 0; k < 6; ++k) EXPECT_EQ(records[k], 0) << k;
  EXPECT_NEAR(records[8], 256 * 0.99, 1e-2);
  EXPECT_EQ(records[11], 0);
}

INSTANTIATE_FOR_EVERY_TARGET(BlendTileBackward);

}  // namespace
}  // namespace oraclegs
