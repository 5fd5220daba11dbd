#include "oraclegs/networks/vggt/aggregator.h"

#include "networks/vggt/fixture.h"

namespace oraclegs::vggt {
namespace {

class AggregatorParity : public OnThreads {};

TEST_P(AggregatorParity, TokensMatchTheOfficialNetwork) {
  const SafetensorsFile file = OpenGolden(kVggtFixture);
  const Aggregator aggregator = GoldenVggt().aggregator;
  const Tensor images = GoldenFloat(file, "input.images");
  const PatchGrid grid = GoldenGrid(file);

  ExpectGolden(PositionEmbedding(aggregator.backbone, grid.rows, grid.cols)[0], file, "debug.patch_pos_embed", 1e-6);
  const Tensor embedded = EmbedViews(aggregator, images);
  ExpectGolden(embedded, file, "debug.tokens_in", 1e-4);
  ExpectGolden(embedded.slice(1, aggregator.special_tokens()), file, "debug.patch_tokens", 1e-4);
  const RopeTable rope =
      MakeRopeTable({aggregator.special_tokens(), grid.rows, grid.cols},
                    aggregator.config.width() / aggregator.config.heads, aggregator.config.rope_base);
  ExpectGolden(Forward(aggregator.frame_blocks[0], embedded, &rope), file, "debug.frame_block0", 1e-4);

  AggregatorRequest request;
  for (int64_t l = 0; l < aggregator.config.depth; ++l) request.token_layers.push_back(l);
  const AggregatorResult result = Aggregate(aggregator, images, request);
  for (const auto& [layer, tokens] : result.tokens) {
    ExpectGolden(tokens, file, "output.aggregated_tokens." + std::to_string(layer), 1e-4);
  }
}

TEST_P(AggregatorParity, GlobalAttentionMatchesTheOfficialNetwork) {
  const SafetensorsFile file = OpenGolden(kVggtFixture);
  const Aggregator aggregator = GoldenVggt().aggregator;
  const AggregatorResult result = Aggregate(aggregator, GoldenFloat(file, "input.images"), {{}, OracleLayers(file)});
  ASSERT_EQ(result.attention.size(), OracleLayers(file).size());
  for (const auto& [layer, attention] : result.attention) {
    const std::string name = ".layer" + std::to_string(layer);
    ExpectGolden(attention.from_patches.flatten(1), file, "output.attention" + name, 1e-6);
    ExpectGolden(attention.from_camera.flatten(1), file, "debug.attention_camera_query" + name, 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Threads, AggregatorParity, testing::ValuesIn(ThreadsAndGpu()));

TEST(Aggregator, WhatIsAskedForDoesNotChangeWhatIsAnswered) {
  const SafetensorsFile file = OpenGolden(kVggtFixture);
  const Aggregator aggregator = GoldenVggt().aggregator;
  const Tensor images = GoldenFloat(file, "input.images");
  const AggregatorResult both = Aggregate(aggregator, images, {{0, 2}, {1, 2}});
  const AggregatorResult attention = Aggregate(aggregator, images, {{}, {2}});
  EXPECT_TRUE(attention.tokens.empty());
  EXPECT_TRUE(torch::equal(both.attention.at(2).from_patches, attention.attention.at(2).from_patches));
  EXPECT_TRUE(torch::equal(both.tokens.at(2), Aggregate(aggregator, images, {{2}, {}}).tokens.at(2)));
}

TEST(Aggregator, ComputesTheQueriesAskedForAlone) {
  const SafetensorsFile file = OpenGolden(kVggtFixture);
  const Aggregator aggregator = GoldenVggt().aggregator;
  const Tensor images = GoldenFloat(file, "input.images");
  const GlobalAttention all = Aggregate(aggregator, images, {{}, {2}}).attention.at(2);
  const GlobalAttention camera = Aggregate(aggregator, images, {{}, {2}, {1, false, true}}).attention.at(2);
  EXPECT_FALSE(camera.from_patches.defined());
  EXPECT_TRUE(torch::equal(camera.from_camera, all.from_camera.slice(0, 0, 1)));
  const GlobalAttention patches = Aggregate(aggregator, images, {{}, {2}, {1, true, false}}).attention.at(2);
  EXPECT_FALSE(patches.from_camera.defined());
  EXPECT_TRUE(torch::equal(patches.from_patches, all.from_patches.slice(0, 0, 1)));
}

TEST(Aggregator, OneViewIsEnough) {
  const SafetensorsFile file = OpenGolden(kVggtFixture);
  const Aggregator aggregator = GoldenVggt().aggregator;
  const Tensor images = GoldenFloat(file, "input.images").slice(0, 0, 1).contiguous();
  EXPECT_EQ(Aggregate(aggregator, images, {{0}, {0}}).attention.at(0).from_patches.size(0), 1);
}

TEST(Aggregator, RefusesLayersThatDoNotExist) {
  const SafetensorsFile file = OpenGolden(kVggtFixture);
  const Aggregator aggregator = GoldenVggt().aggregator;
  const Tensor images = GoldenFloat(file, "input.images");
  EXPECT_THROW(Aggregate(aggregator, images, {{}, {}}), ShapeError);
  EXPECT_THROW(Aggregate(aggregator, images, {{aggregator.config.depth}, {}}), ShapeError);
  EXPECT_THROW(Aggregate(aggregator, images, {{0}, {-1}}), ShapeError);
  EXPECT_THROW(Aggregate(aggregator, images.slice(2, 1), {{0}, {}}), ShapeError);
}

}  // namespace
}  // namespace oraclegs::vggt
