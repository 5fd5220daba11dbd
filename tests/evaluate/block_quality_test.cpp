#include "oraclegs/evaluate/block_quality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

/// Blocks side by side, each of one error and one confidence.
ErrorMap Blocks(const std::vector<float>& error, const std::vector<float>& confidence) {
  ErrorMap map{kBlockSide * static_cast<int>(error.size()), kBlockSide, {}, {}, {}};
  for (int i = 0; i < map.width * map.height; ++i) {
    const auto b = static_cast<size_t>(i % map.width / kBlockSide);
    map.error.push_back(error[b]), map.confidence.push_back(confidence[b]), map.counts.push_back(true);
  }
  return map;
}

BlockQuality QualityOf(const ErrorMap& map) {
  BlockSamples samples;
  samples.Add(map);
  return samples.Quality();
}

TEST(BlockSamples, OrdersFourBlocksByHand) {
  const BlockQuality q = QualityOf(Blocks({0.2f, 0.4f, 0, 0.04f}, {0.5f, 0.1f, 0.5f, 0.9f}));
  EXPECT_EQ(q.blocks, 4);
  // Ranks of confidence 2.5 1 2.5 4, of -error 2 1 4 3: deviations 0 -1.5 0 1.5 and -.5 -1.5 1.5 .5.
  EXPECT_NEAR(q.spearman, 3 / std::sqrt(4.5 * 5), 1e-12);
  // Wrong blocks have confidence .5 and .1, the others .5 and .9: three pairs in order and a tie.
  EXPECT_DOUBLE_EQ(q.auroc_large_error, 3.5 / 4);
}

TEST(BlockSamples, SeparatesMeanAndRms) {
  // One pixel of 64 is wrong by 0.8: the mean is 0.0125, the RMS 0.1.
  ErrorMap map = Blocks({0, 0.02f}, {0.3f, 0.6f});
  map.error[0] = 0.8f;
  const BlockQuality q = QualityOf(map);
  EXPECT_EQ(q.auroc_large_error, 1) << "the first block alone is wrong by its RMS";
  EXPECT_NEAR(q.spearman, -1, 1e-12) << "but has the smaller mean error";
}

TEST(BlockSamples, LeavesOutSmallRemains) {
  ErrorMap map = Blocks({0.2f, 0.4f}, {0.5f, 0.1f});
  for (int i = 0; i < map.width * map.height; ++i) {
    if (i % map.width < kBlockSide && i / map.width >= 4) map.counts[static_cast<size_t>(i)] = false;
  }
  EXPECT_EQ(QualityOf(map).blocks, 2);
  map.counts[0] = false;  // 31 of 64 are left
  EXPECT_EQ(QualityOf(map).blocks, 1);

  ErrorMap strip{10, 8, std::vector<float>(80, 0.1f), std::vector<float>(80, 0.5f), std::vector<bool>(80, true)};
  EXPECT_EQ(QualityOf(strip).blocks, 1) << "two columns are a quarter of a block";
}

TEST(BlockSamples, JoinsImagesAndSaysWhereThereIsNothing) {
  BlockSamples samples;
  EXPECT_EQ(samples.Quality().blocks, 0);
  samples.Add(Blocks({0.2f}, {0.1f}));
  EXPECT_TRUE(ToJson(samples.Quality()).at("auroc_large_error").is_null());
  samples.Add(Blocks({0.01f}, {0.9f}));
  EXPECT_EQ(samples.Quality().auroc_large_error, 1);
  EXPECT_EQ(ToJson(samples.Quality()).at("blocks"), 2);
  ErrorMap broken = Blocks({0.2f}, {0.1f});
  broken.counts.pop_back();
  EXPECT_THROW(samples.Add(broken), ShapeError);
}

}  // namespace
}  // namespace oraclegs
