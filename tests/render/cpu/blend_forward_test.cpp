#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "render/cpu/every_target.h"
#include "render/cpu/splats.h"

namespace oraclegs {
namespace {

/// Planes of an image of one tile, possibly cropped.
struct OneTile {
  int width, height;
  std::vector<float> image, alpha, inv_depth, transmittance;
  std::vector<uint32_t> end;

  OneTile(int w, int h)
      : width(w), height(h), image(3 * w * h), alpha(w * h), inv_depth(w * h), transmittance(256), end(256) {}
  cpu::BlendImage planes() {
    return {width, height, {0, 0, 1}, image.data(), alpha.data(), inv_depth.data(), transmittance.data(), end.data()};
  }
};

class BlendTile : public EveryTarget {};

TEST_P(BlendTile, BlendsNearToFar) {
  const double wide[3] = {1e8, 0, 1e8};  // flat over the tile
  const std::vector<cpu::LineSplat> splats = {MakeSplat(8, 8, wide, 0.5, 2), MakeSplat(8, 8, wide, 0.25, 4)};
  const std::vector<cpu::TileEntry> entries = {{0, 0xffff, 0}, {1, 0xffff, 1}};
  OneTile tile(16, 16);
  cpu::BlendTile({splats.data(), entries.data(), 2, 0, 0, 0, 0}, tile.planes());
  for (int pixel = 0; pixel < 256; ++pixel) {
    EXPECT_NEAR(tile.alpha[pixel], 1 - 0.5 * 0.75, 1e-5);
    EXPECT_NEAR(tile.inv_depth[pixel], 0.5 / 2 + 0.5 * 0.25 / 4, 1e-5);
    EXPECT_NEAR(tile.image[3 * pixel], 0.9 * 0.625, 1e-5);
    EXPECT_NEAR(tile.image[3 * pixel + 2], 0.1 * 0.625 + 0.375, 1e-5);
    EXPECT_EQ(tile.end[pixel], 2u);
  }
}

TEST_P(BlendTile, StopsWhereOpaque) {
  // 0.99 twice leaves less than 1e-4 in float32: the second one contributes nothing (docs/method.md#blending).
  const double wide[3] = {1e8, 0, 1e8};
  const std::vector<cpu::LineSplat> splats(3, MakeSplat(8, 8, wide, 0.999));
  const std::vector<cpu::TileEntry> entries = {{0, 0xffff, 0}, {1, 0xffff, 1}, {2, 0xffff, 2}};
  OneTile tile(16, 16);
  cpu::BlendTile({splats.data(), entries.data(), 3, 0, 0, 0, 0}, tile.planes());
  EXPECT_FLOAT_EQ(tile.alpha[0], 0.99f);
  EXPECT_EQ(tile.end[0], 1u);
}

TEST_P(BlendTile, BlendsListsOfManySegments) {
  const double wide[3] = {1e8, 0, 1e8};
  const int n = 1000;
  const std::vector<cpu::LineSplat> splats(n, MakeSplat(8, 8, wide, 0.005));
  std::vector<cpu::TileEntry> entries;
  for (uint32_t i = 0; i < n; ++i) entries.push_back({i, 0xffff, i});
  OneTile tile(16, 16);
  cpu::BlendTile({splats.data(), entries.data(), n, 0, 0, 0, 0}, tile.planes());
  EXPECT_NEAR(tile.alpha[100], 1 - std::pow(0.995, n), 1e-4);
}

TEST_P(BlendTile, WritesOnlyMaskedBlocksInTheImage) {
  const double wide[3] = {1e8, 0, 1e8};
  const std::vector<cpu::LineSplat> splats = {MakeSplat(8, 8, wide, 0.5)};
  const std::vector<cpu::TileEntry> entries = {{0, 1u << 5, 0}};  // block (1, 1)
  OneTile tile(7, 6);
  cpu::BlendTile({splats.data(), entries.data(), 1, 0, 0, 0, 0}, tile.planes());
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 7; ++x) EXPECT_NEAR(tile.alpha[7 * y + x], x >= 4 && y >= 4 ? 0.5 : 0, 2e-6) << x << ' ' << y;
  }
}

INSTANTIATE_FOR_EVERY_TARGET(BlendTile);

}  // namespace
}  // namespace oraclegs
