#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/cpu/every_target.h"
#include "render/cpu/splats.h"

namespace oraclegs {
namespace {

constexpr int kTilesX = 5, kTilesY = 4;

class CoverTiles : public EveryTarget {};

TEST_P(CoverTiles, MasksTheReachedBlocks) {
  Rng rng(3, RandomStream::kInitialPoints);
  int64_t reached = 0, listed = 0;
  for (int i = 0; i < 400; ++i) {
    const cpu::LineSplat s = RandomSplat(&rng, kTilesX * kTile, kTilesY * kTile);
    uint32_t tiles[kTilesX * kTilesY + 1], blocks[kTilesX * kTilesY + 1], masks[kTilesX * kTilesY] = {};
    cpu::PairRange range;
    const TileRect everywhere{0, 0, kTilesX, kTilesY};
    const uint32_t n = cpu::CoverTiles({&s, &everywhere, kTilesX}, 0, 1, 0, {tiles, blocks, &range});
    EXPECT_EQ(range.begin, 0u);
    EXPECT_EQ(range.count, n);
    for (uint32_t j = 0; j < n; ++j) {
      EXPECT_NE(blocks[j], 0u);
      masks[tiles[j]] = blocks[j];
    }
    for (int tile = 0; tile < kTilesX * kTilesY; ++tile) {
      for (int block = 0; block < cpu::kBlocksPerTile; ++block) {
        const int x0 = tile % kTilesX * kTile + block % 4 * 4, y0 = tile / kTilesX * kTile + block / 4 * 4;
        double best = 0;  // over the block's pixel centers and the points between them
        for (double y = 0.5; y <= 3.5; y += 0.25) {
          for (double x = 0.5; x <= 3.5; x += 0.25) best = std::max(best, AlphaAt(s, x0 + x, y0 + y));
        }
        const bool in_mask = masks[tile] >> block & 1;
        if (best >= 1.0 / 255) {
          EXPECT_TRUE(in_mask) << "splat " << i << " tile " << tile << " block " << block << " alpha " << best;
        }
        reached += best >= 1.0 / 255;
        listed += in_mask;
      }
    }
  }
  EXPECT_GT(reached, 5000);
  EXPECT_LT(static_cast<double>(listed), 1.02 * static_cast<double>(reached));
}

INSTANTIATE_FOR_EVERY_TARGET(CoverTiles);

}  // namespace
}  // namespace oraclegs
