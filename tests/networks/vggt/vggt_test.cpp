#include "oraclegs/networks/vggt/vggt.h"

#include <gtest/gtest.h>

#include "networks/vggt/fixture.h"

namespace oraclegs::vggt {
namespace {

class VggtParity : public OnThreads {};

TEST_P(VggtParity, CamerasAndDepthMatchTheOfficialNetwork) {
  const SafetensorsFile file = OpenGolden(kVggtFixture);
  const Vggt vggt = GoldenVggt();
  const PatchGrid grid = GoldenGrid(file);
  const AggregatorResult aggregated =
      Aggregate(vggt.aggregator, GoldenFloat(file, "input.images"), {HeadLayers(vggt), {}});
  ExpectGolden(PredictCameras(vggt, aggregated).back(), file, "output.pose_enc", 5e-5);
  const DepthPrediction depth = PredictDepth(vggt, aggregated, grid);
  ExpectGolden(depth.depth, file, "output.depth", 2e-4);
  ExpectGolden(depth.confidence, file, "output.depth_conf", 2e-4);
}

INSTANTIATE_TEST_SUITE_P(Threads, VggtParity, testing::ValuesIn(ThreadsAndGpu()));

TEST(Vggt, SameBitsForAnyNumberOfThreads) {
  const SafetensorsFile file = OpenGolden(kVggtFixture);
  const Vggt vggt = GoldenVggt();
  const auto run = [&](int threads) {
    at::set_num_threads(threads);
    const AggregatorResult aggregated =
        Aggregate(vggt.aggregator, GoldenFloat(file, "input.images"), {HeadLayers(vggt), OracleLayers(file)});
    return std::vector<Tensor>{PredictCameras(vggt, aggregated).back(),
                               PredictDepth(vggt, aggregated, GoldenGrid(file)).depth,
                               aggregated.attention.at(OracleLayers(file).back()).from_patches};
  };
  const int before = at::get_num_threads();
  const std::vector<Tensor> one = run(1), three = run(3);
  at::set_num_threads(before);
  for (size_t i = 0; i < one.size(); ++i) EXPECT_TRUE(torch::equal(one[i], three[i])) << i;
}

TEST(Vggt, NamesAndShapesAreThoseOfThePublishedNetwork) {
  ListedParameters parameters;
  LoadVggt(parameters, Config(), {true, true});
  auto expected = GoldenParameterList("vggt_params.tsv", "track_head.");
  std::erase_if(expected, [](const auto& tensor) { return tensor.first.starts_with("point_head."); });
  ASSERT_EQ(expected.size(), 1797u - 394u - 62u);
  EXPECT_EQ(parameters.shapes(), expected);
}

TEST(Vggt, AnOracleLoadsTheAggregatorAlone) {
  ListedParameters parameters;
  const Vggt vggt = LoadVggt(parameters, Config(), {});
  EXPECT_EQ(parameters.shapes().size(), 1210u);
  EXPECT_TRUE(HeadLayers(vggt).empty());
  EXPECT_THROW(PredictCameras(vggt, {}), ShapeError);
  EXPECT_THROW(PredictDepth(vggt, {}, {}), ShapeError);
}

TEST(Vggt, HeadsReadTheLayersOfTheSpecification) {
  ListedParameters parameters;
  EXPECT_EQ(HeadLayers(LoadVggt(parameters, Config(), {true, false})), std::vector<int64_t>{23});
  EXPECT_EQ(HeadLayers(LoadVggt(parameters, Config(), {false, true})), (std::vector<int64_t>{4, 11, 17, 23}));
}

TEST(Vggt, TokensThatWereNotKeptAreNamed) {
  const Vggt vggt = GoldenVggt();
  EXPECT_THAT([&] { PredictCameras(vggt, {}); },
              testing::ThrowsMessage<ShapeError>(testing::HasSubstr("the tokens of layer")));
}

TEST(Vggt, AFileOfAnotherNetworkIsRefusedByName) {
  EXPECT_THAT(
      [] {
        LoadVggt({GoldenDir() / "lpips_tiny.safetensors"}, {true, false});
      },
      testing::ThrowsMessage<InputError>(
          testing::AllOf(testing::HasSubstr("lpips_tiny.safetensors: does not hold VGGT-1B; missing 1278: "),
                         testing::HasSubstr("not part of it"))));
}

TEST(Vggt, TakesHalfPrecisionOnAGpuOnly) {
  EXPECT_EQ(PlaceOn(torch::kCPU).aggregator_type, torch::kFloat);
  const Placement gpu = PlaceOn({torch::kCUDA, 1});
  EXPECT_EQ(gpu.aggregator_type, torch::kBFloat16);
  EXPECT_EQ(gpu.device, torch::Device(torch::kCUDA, 1));
  EXPECT_EQ(PlaceOn(torch::kCPU, VggtPrecision::kBFloat16).aggregator_type, torch::kBFloat16);
  EXPECT_EQ(PlaceOn({torch::kCUDA, 1}, VggtPrecision::kFloat32).aggregator_type, torch::kFloat);
  const Placement mixed = PlaceOn({torch::kCUDA, 1}, VggtPrecision::kAutocast);
  EXPECT_EQ(mixed.aggregator_type, torch::kFloat);
  EXPECT_EQ(mixed.products, torch::kBFloat16);
}

TEST(Vggt, AutocastKeepsTokensInFloatAndNearerThanHalfWeights) {
  const SafetensorsFile file = OpenGolden(kVggtFixture);
  Vggt vggt = GoldenVggt();
  const Tensor images = GoldenFloat(file, "input.images");
  const int64_t last = vggt.config.aggregator.depth - 1;
  const AggregatorRequest request{HeadLayers(vggt), OracleLayers(file)};
  const AggregatorResult exact = Aggregate(vggt.aggregator, images, request);
  vggt.aggregator.products = torch::kBFloat16;
  const AggregatorResult mixed = Aggregate(vggt.aggregator, images, request);
  EXPECT_EQ(mixed.tokens.at(last).scalar_type(), torch::kFloat);
  const double error = RelativeL2(mixed.tokens.at(last), exact.tokens.at(last));
  EXPECT_GT(error, 1e-5);
  EXPECT_LT(error, 0.02);
  for (const auto& [layer, attention] : mixed.attention) {
    EXPECT_EQ(attention.from_camera.scalar_type(), torch::kFloat);
    EXPECT_LT(RelativeL2(attention.from_camera, exact.attention.at(layer).from_camera), 0.05);
  }
  vggt.aggregator.products.reset();
  EXPECT_TRUE(torch::equal(Aggregate(vggt.aggregator, images, request).tokens.at(last), exact.tokens.at(last)));
}

TEST(Vggt, HalfPrecisionAggregatorStaysNearFloat) {
  const SafetensorsFile file = OpenGolden(kVggtFixture);
  CheckpointOptions options;
  options.prefix = "weights.";
  options.ignored = {"point_head."};
  options.cast_type = torch::kBFloat16;
  options.cast_prefix = "aggregator.";
  FileParameters source({GoldenDir() / (std::string(kVggtFixture) + ".safetensors")}, options);
  const Vggt half = LoadVggt(source, GoldenVggtConfig(), {true, true});
  source.Finish();
  const int64_t last = half.config.aggregator.depth - 1;
  const AggregatorResult aggregated =
      Aggregate(half.aggregator, GoldenFloat(file, "input.images"), {HeadLayers(half), OracleLayers(file)});
  EXPECT_EQ(aggregated.tokens.at(last).scalar_type(), torch::kBFloat16);
  EXPECT_LT(
      RelativeL2(aggregated.tokens.at(last), GoldenTensor(file, "output.aggregated_tokens." + std::to_string(last))),
      0.05);
  EXPECT_EQ(PredictDepth(half, aggregated, GoldenGrid(file)).depth.scalar_type(), torch::kFloat);
  for (const auto& [layer, attention] : aggregated.attention) {
    const Tensor expected = GoldenTensor(file, "output.attention.layer" + std::to_string(layer));
    EXPECT_LT(RelativeL2(attention.from_patches.flatten(1), expected), 0.05);
  }
}

TEST(VggtMemory, WeightsAreThoseOfTheSpecification) {
  EXPECT_EQ(WeightBytes({}, {}), 909112320 * int64_t{4});
  EXPECT_EQ(WeightBytes({}, {true, true}), (909112320 + 216174610 + 32654562) * int64_t{4});
}

TEST(VggtMemory, APassGrowsWithWhatIsAsked) {
  const Pass few{2, 350, 518, {}}, many{9, 350, 518, {}}, large{2, 518, 518, {}};
  const Pass heads{2, 350, 518, {true, true}};
  const int64_t bytes = PassBytes({}, few);
  EXPECT_GT(bytes, int64_t{128} << 20);
  EXPECT_LT(bytes, int64_t{1} << 30);
  EXPECT_GT(PassBytes({}, many), bytes);
  EXPECT_GT(PassBytes({}, large), bytes);
  EXPECT_GT(PassBytes({}, heads), bytes);
  // Four views of 518 x 350 fit into 3 GiB beside the weights.
  EXPECT_LT(PassBytes({}, {4, 350, 518, {true, true}}), int64_t{3} << 30);
}

}  // namespace
}  // namespace oraclegs::vggt
