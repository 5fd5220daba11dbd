#include "oraclegs/networks/vggt/attention_confidence.h"

#include "networks/vggt/fixture.h"

namespace oraclegs::vggt {
namespace {

class VggtConfidenceParity : public OnThreads {};

TEST_P(VggtConfidenceParity, MatchesTheReferenceInBothModes) {
  const SafetensorsFile file = OpenGolden(kVggtFixture);
  const PatchGrid grid = GoldenGrid(file);
  const AggregatorResult result =
      Aggregate(GoldenVggt().aggregator, GoldenFloat(file, "input.images"), {{}, OracleLayers(file)});
  const std::vector<int64_t> layers = OracleLayers(file);
  const std::vector<double> weights = Numbers(file, "oracle_weights");
  std::vector<WeightedAttention> weighted;
  for (size_t i = 0; i < layers.size(); ++i) weighted.push_back({result.attention.at(layers[i]), weights.at(i)});
  for (const auto& [mode, name] :
       {std::pair{AttentionMode::kOthers, "others"}, std::pair{AttentionMode::kReference, "reference"}}) {
    const Tensor confidence = PatchConfidence(weighted, mode, grid);
    ExpectGolden(confidence, file, std::string("debug.uncertainty_patch.") + name, 5e-5);
    ExpectGolden(UpsampleConfidence(confidence, Count(file, "height"), Count(file, "width")), file,
                 std::string("output.uncertainty.") + name, 5e-5);
  }
}

INSTANTIATE_TEST_SUITE_P(Threads, VggtConfidenceParity, testing::ValuesIn(ThreadsAndGpu()));

/// Two views of two patches.
WeightedAttention TwoViews() {
  const Tensor patches = torch::tensor({1e-7f, 3e-7f, 5e-7f, 4e-7f, 2e-7f, 9e-7f, 7e-7f, 7e-7f}).view({2, 2, 2});
  const Tensor camera = torch::tensor({0.1f, 0.2f, 0.3f, 0.5f, 0.f, 0.f, 9.f, 9.f}).view({2, 2, 2});
  return {{patches, camera}, 0.5};
}

TEST(PatchConfidence, EachModeReadsItsQueries) {
  const auto values = [](AttentionMode mode) { return PatchConfidence({TwoViews()}, mode, {1, 2}).flatten(); };
  EXPECT_LT(MaxAbsError(values(AttentionMode::kOthers), torch::tensor({0.f, 0.5f, 0.5f, 0.f})), 1e-6);
  EXPECT_LT(MaxAbsError(values(AttentionMode::kReference), torch::tensor({0.f, 0.5f, 0.5f, 0.f})), 1e-6);
  EXPECT_LT(MaxAbsError(values(AttentionMode::kOfficial), torch::tensor({0.f, 0.125f, 0.25f, 0.5f})), 1e-6);
}

TEST(PatchConfidence, NeedsNoMoreThanTheQueriesOfItsMode) {
  const WeightedAttention all = TwoViews();
  for (const auto mode : {AttentionMode::kOthers, AttentionMode::kReference, AttentionMode::kOfficial}) {
    const AttentionQueries queries = QueriesOf(mode);
    const int64_t views = queries.views > 0 ? queries.views : 2;
    WeightedAttention some{{}, all.weight};
    if (queries.patches) some.attention.from_patches = all.attention.from_patches.slice(0, 0, views);
    if (queries.camera) some.attention.from_camera = all.attention.from_camera.slice(0, 0, views);
    EXPECT_TRUE(torch::equal(PatchConfidence({some}, mode, {1, 2}), PatchConfidence({all}, mode, {1, 2})));
    EXPECT_NE(queries.patches, queries.camera);
  }
  EXPECT_THROW(PatchConfidence({{{}, 1}}, AttentionMode::kOfficial, {1, 2}), ShapeError);
}

TEST(PatchConfidence, AConstantMapIsZero) {
  const WeightedAttention flat{{torch::full({2, 2, 3}, 1e-4f), torch::full({2, 2, 3}, 1e-4f)}, 1};
  for (const auto mode : {AttentionMode::kOthers, AttentionMode::kReference, AttentionMode::kOfficial}) {
    EXPECT_EQ(PatchConfidence({flat}, mode, {3, 1}).abs().max().item<float>(), 0);
  }
}

TEST(PatchConfidence, RefusesWhatHasNoAnswer) {
  const WeightedAttention alone{{torch::rand({1, 1, 4}), torch::rand({1, 1, 4})}, 1};
  EXPECT_NO_THROW(PatchConfidence({alone}, AttentionMode::kReference, {2, 2}));
  EXPECT_THROW(PatchConfidence({alone}, AttentionMode::kOthers, {2, 2}), ShapeError);
  EXPECT_THROW(PatchConfidence({alone}, AttentionMode::kReference, {2, 3}), ShapeError);
  EXPECT_THROW(PatchConfidence({}, AttentionMode::kReference, {2, 2}), ShapeError);
  EXPECT_THROW(UpsampleConfidence(torch::rand({2, 2}), 4, 4), ShapeError);
}

}  // namespace
}  // namespace oraclegs::vggt
