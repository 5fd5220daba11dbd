#include "oraclegs/validate/vggt_oracle.h"

#include <gmock/gmock.h>

#include <numeric>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/rng.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

constexpr int kImageWidth = 12, kImageHeight = 8;

double Mean(const Image8& image) {
  return std::accumulate(image.data.begin(), image.data.end(), 0.0) / static_cast<double>(image.data.size()) / 255;
}

/// Network with outputs that depend on the pixel and on all views of the pass.
class FakeAttention : public AttentionNetwork {
 public:
  explicit FakeAttention(std::vector<size_t>* passes) : passes_(passes) {}
  int64_t PassBytes(const std::vector<Camera>&, int64_t views) const override { return views; }
  void Load() override {}
  std::vector<Buffer<float>> Confidence(const std::vector<Image8>& views, const std::vector<size_t>& asked) override {
    if (passes_) passes_->push_back(asked.size());
    double together = 0;
    for (const Image8& view : views) together += Mean(view);
    std::vector<Buffer<float>> maps;
    for (const size_t a : asked) {
      maps.push_back(Buffer<float>::Empty({views[a].height, views[a].width}));
      for (int64_t i = 0; i < maps.back().count(); ++i) {
        maps.back()[i] = static_cast<float>(views[a].data[static_cast<size_t>(3 * i)] / 510.0 + together / 100);
      }
    }
    return maps;
  }

 private:
  std::vector<size_t>* passes_;
};

Camera CameraOf(int width, int height) { return {width, height, 60, 60, width / 2.0, height / 2.0, {}}; }

Proposal Noise(uint64_t seed, int width = kImageWidth, int height = kImageHeight) {
  ImageF image{width, height, 3, {}};
  Rng rng(seed, RandomStream::kDemoScene);
  for (int i = 0; i < 3 * width * height; ++i) image.data.push_back(static_cast<float>(rng.Uniform()));
  return {"p", "warp", CameraOf(width, height), image};
}

class VggtOracleTest : public testing::Test {
 protected:
  VggtOracleTest() { views.push_back({"view", CameraOf(kImageWidth, kImageHeight), Noise(77).rgb, {}}); }

  VggtOracle Oracle(size_t chunk = 8, std::function<void(size_t)> on_pass = {}, std::vector<size_t>* passes = nullptr) {
    return {std::make_unique<FakeAttention>(passes), {.chunk = chunk, .on_pass = std::move(on_pass)}, views};
  }

  std::vector<LoadedView> views;
  const std::vector<Proposal> proposals = {Noise(1), Noise(2)};
};

TEST_F(VggtOracleTest, PassesAreIndependentAndReported) {
  const std::vector<Proposal> five = {Noise(1), Noise(2), Noise(3), Noise(4), Noise(5)};
  std::vector<size_t> reported, passes;
  const VggtOracle oracle = Oracle(
      2, [&](size_t n) { reported.push_back(n); }, &passes);
  const auto maps = oracle.Predict(five);
  EXPECT_EQ(reported, (std::vector<size_t>{1, 2, 2}));  // even runs of at most two
  EXPECT_EQ(passes, reported);
  EXPECT_EQ(maps[0], oracle.Predict(std::vector<Proposal>{five[0]})[0]);
  EXPECT_EQ(maps[2], oracle.Predict(std::vector<Proposal>{five[1], five[2]})[1]);
  EXPECT_EQ(maps[4], oracle.Predict(std::vector<Proposal>{five[3], five[4]})[1]);
  EXPECT_NE(maps[2], oracle.Predict(std::vector<Proposal>{five[4], five[2]})[1]);
  EXPECT_EQ(maps, Oracle(2).Predict(five));
}

TEST_F(VggtOracleTest, MapsHaveTheSizeOfTheirProposals) {
  const auto maps = Oracle().Predict(std::vector<Proposal>{Noise(1, 50, 33), Noise(2, 31, 64), Noise(3, 50, 33)});
  EXPECT_EQ(maps[0].size(), 50u * 33u);
  EXPECT_EQ(maps[1].size(), 31u * 64u);
  EXPECT_EQ(maps[2].size(), 50u * 33u);
}

TEST_F(VggtOracleTest, AHeldOutViewIsNotLookedAt) {
  views.push_back({"second", CameraOf(kImageWidth, kImageHeight), Noise(9).rgb, {}});
  const VggtOracle oracle = Oracle();
  const auto beside = [&](int held_out) { return oracle.Predict(std::vector<Query>{{proposals[0], held_out}})[0]; };
  const ConfidenceMap beside_first = beside(1), beside_second = beside(0);
  EXPECT_NE(beside_first, beside_second);
  views[1].rgb = Noise(10).rgb;
  EXPECT_EQ(beside(1), beside_first);
  EXPECT_NE(beside(0), beside_second);
  views.pop_back();
  EXPECT_THROW(beside(0), InputError);
}

TEST_F(VggtOracleTest, APassOverAllMixesImagesAndProposalsInAnOrderOfTheSeed) {
  for (int v = 0; v < 3; ++v) views.push_back({"more", CameraOf(20, 10), Noise(90 + v, 20, 10).rgb, {}});
  const std::vector<Proposal> five = {Noise(1), Noise(2, 20, 10), Noise(3), Noise(4), Noise(5)};
  std::vector<size_t> passes;
  size_t reported = 0;
  const auto at_seed = [&](uint64_t seed, size_t chunk) {
    passes.clear(), reported = 0;
    return VggtOracle(std::make_unique<FakeAttention>(&passes),
                      {OraclePass::kAll, chunk, seed, [&](size_t n) { reported += n; }}, views)
        .Predict(five);
  };
  const auto maps = at_seed(1, 4);
  EXPECT_LE(passes.size(), 3u);  // nine images in runs of three; one without a proposal is not run
  EXPECT_EQ(reported, 5u);
  EXPECT_EQ(maps[1].size(), 200u);
  EXPECT_EQ(at_seed(1, 4), maps);
  EXPECT_NE(at_seed(2, 4), maps) << "others are in the pass";
  EXPECT_EQ(at_seed(1, 96).size(), 5u);
  EXPECT_EQ(passes, std::vector<size_t>{5});
  EXPECT_THROW(VggtOracle(std::make_unique<FakeAttention>(nullptr), {.pass = OraclePass::kAll}, views)
                   .Predict(std::vector<Query>{{five[0], 0}}),
               ShapeError);
}

TEST_F(VggtOracleTest, StopsWhenAskedTo) {
  const VggtOracle oracle = Oracle();
  RequestInterrupt(true);
  EXPECT_THROW(oracle.Predict(proposals), Interrupted);
  RequestInterrupt(false);
  EXPECT_EQ(oracle.Predict(proposals).size(), 2u);
}

TEST_F(VggtOracleTest, RefusesEmptyChunks) { EXPECT_THROW(Oracle(0), ShapeError); }

using testing::AllOf;
using testing::HasSubstr;

ValidateOptions With(const std::string& layers, const std::string& weights) {
  ValidateOptions options;
  options.vggt_layers = layers, options.vggt_layer_weights = weights;
  return options;
}

std::string Refusal(const std::string& layers, const std::string& weights) {
  return MessageOf<UsageError>([&] { AttentionLayersOf(With(layers, weights)); });
}

TEST(AttentionLayers, AreLeftToTheFileByDefault) { EXPECT_TRUE(AttentionLayersOf({}).empty()); }

TEST(AttentionLayers, HaveWeightsThatSumToOne) {
  const auto layers = AttentionLayersOf(With("0, 22", "1,3"));
  ASSERT_EQ(layers.size(), 2u);
  EXPECT_EQ(layers[0].layer, 0);
  EXPECT_EQ(layers[1].layer, 22);
  EXPECT_EQ(layers[0].weight, 0.25);
  EXPECT_EQ(layers[1].weight, 0.75);
  const auto with_zero = AttentionLayersOf(With("4,11,17", "0,0.5,0"));
  EXPECT_EQ(with_zero[0].weight, 0);
  EXPECT_EQ(with_zero[1].weight, 1);
}

TEST(AttentionLayers, CountAlikeWithoutWeights) {
  for (const LayerWeight& layer : AttentionLayersOf(With("3,1,7,5", ""))) EXPECT_EQ(layer.weight, 0.25);
  EXPECT_EQ(AttentionLayersOf(With("11", "")).at(0).weight, 1);
}

TEST(AttentionLayers, RefuseWhatIsNoListOfThem) {
  for (const char* layers : {"x", "0,2.5", "-1", "0;22", "99999999999999999999"}) {
    EXPECT_THAT(Refusal(layers, ""), AllOf(HasSubstr("--set vggt-layers: '"), HasSubstr("number of a layer")))
        << layers;
  }
  for (const char* weights : {"1,x", "1,-3", "1,nan", "inf,1", "1,1e999"}) {
    EXPECT_THAT(Refusal("0,22", weights), AllOf(HasSubstr("--set vggt-layer-weights: '"), HasSubstr("a number from 0")))
        << weights;
  }
  EXPECT_THAT(Refusal("0,22,0", ""), HasSubstr("--set vggt-layers names layer 0 more than once"));
  EXPECT_THAT(Refusal("0,22", "1,2,3"), HasSubstr("names 2 layers, --set vggt-layer-weights 3"));
  EXPECT_THAT(Refusal("0,22", "1"), HasSubstr("give each layer one weight"));
  EXPECT_THAT(Refusal("0,22", "0,0"), HasSubstr("at least one must be above 0"));
  EXPECT_THAT(Refusal("", "1,3"), HasSubstr("--set vggt-layer-weights needs --set vggt-layers"));
}

TEST(AttentionLayers, MustBeAmongTheNetworks) {
  const auto layers = AttentionLayersOf(With("0,23", ""));
  EXPECT_NO_THROW(RequireAttentionLayers(layers, 24, "VGGT-1B"));
  EXPECT_NO_THROW(RequireAttentionLayers({}, 1, "VGGT-1B"));
  EXPECT_THAT(MessageOf<UsageError>([&] { RequireAttentionLayers(layers, 23, "VGGT-1B"); }),
              HasSubstr("--set vggt-layers names layer 23; VGGT-1B has the layers 0 to 22"));
}

}  // namespace
}  // namespace oraclegs
