#include "oraclegs/networks/vggt/attention_network.h"

#include <numeric>

#include "networks/vggt/fixture.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/rng.h"
#include "support/temp_dir.h"

namespace oraclegs::vggt {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kWidth = 84, kHeight = 56;

Image8 ToImage(const Tensor& chw) {
  const Tensor hwc = chw.permute({1, 2, 0}).contiguous();
  const float* values = hwc.data_ptr<float>();
  return ToImage8({static_cast<int>(hwc.size(1)), static_cast<int>(hwc.size(0)), 3, {values, values + hwc.numel()}});
}

Image8 Noise(uint64_t seed, int width = kWidth, int height = kHeight) {
  ImageF image{width, height, 3, {}};
  Rng rng(seed, RandomStream::kDemoScene);
  for (int i = 0; i < 3 * width * height; ++i) image.data.push_back(static_cast<float>(rng.Uniform()));
  return ToImage8(image);
}

class AttentionTest : public testing::Test {
 protected:
  AttentionTest() {
    const Tensor images = GoldenFloat(file, "input.images");
    reference = ToImage(images[0]);
    for (int v = 1; v < 3; ++v) proposals.push_back(ToImage(images[v]));
  }

  /// At the size of the fixture's images, which are not resized then.
  Tensor Maps(AttentionMode mode, const std::vector<Image8>& of) const {
    return at::stack(AttentionOn(aggregator, {mode, kWidth, {0, 2}, {0.25, 0.75}}, Beside(of), Behind(of)));
  }

  /// The views of a pass: the reference, then the proposals.
  std::vector<Image8> Beside(const std::vector<Image8>& of) const {
    std::vector<Image8> views = {reference};
    views.insert(views.end(), of.begin(), of.end());
    return views;
  }

  /// The numbers of all views of a pass but the reference.
  static std::vector<size_t> Behind(const std::vector<Image8>& of) {
    std::vector<size_t> asked(of.size());
    std::iota(asked.begin(), asked.end(), size_t{1});
    return asked;
  }

  const SafetensorsFile file = OpenGolden(kVggtFixture);
  const Aggregator aggregator = GoldenVggt().aggregator;
  Image8 reference;
  std::vector<Image8> proposals;
};

TEST_F(AttentionTest, MatchesThePublishedMapUpToRoundingOfImages) {
  for (const auto& [mode, name] :
       {std::pair{AttentionMode::kOthers, "others"}, std::pair{AttentionMode::kReference, "reference"}}) {
    const Tensor golden = GoldenFloat(file, std::string("output.uncertainty.") + name).slice(0, 1);
    EXPECT_LT(MaxAbsError(Maps(mode, proposals), golden), 0.05) << name;
  }
}

TEST_F(AttentionTest, ModesDifferInWhoseAttentionCounts) {
  const Tensor a = Maps(AttentionMode::kReference, proposals), b = Maps(AttentionMode::kOthers, proposals),
               c = Maps(AttentionMode::kOfficial, proposals);
  EXPECT_GT(MaxAbsError(a[0], b[0]), 0.02);
  EXPECT_GT(MaxAbsError(a[0], c[0]), 0.02);
  EXPECT_GT(MaxAbsError(b[0], c[0]), 0.02);
  for (const Tensor& maps : {a, b, c}) {
    ASSERT_EQ(maps.sizes(), (std::vector<int64_t>{2, kHeight, kWidth}));
    EXPECT_GE(maps.min().item<float>(), 0.f);
    EXPECT_LE(maps.max().item<float>(), 1.f);
  }
  // The extremes of a view are its own, but for the official map, where they are those of all views of the pass.
  EXPECT_GT((a[0].max() - a[0].min()).item<float>(), 0.4f);
  EXPECT_GT((b[1].max() - b[1].min()).item<float>(), 0.4f);
  // What else is in the pass changes what its own attention is, and in "others" who attends.
  EXPECT_GT(MaxAbsError(Maps(AttentionMode::kOthers, {proposals[0], Noise(5)})[0], b[0]), 1e-3);
}

TEST_F(AttentionTest, SameBitsForAnyNumberOfThreads) {
  const int before = at::get_num_threads();
  at::set_num_threads(1);
  const Tensor one = Maps(AttentionMode::kReference, proposals);
  at::set_num_threads(3);
  const Tensor three = Maps(AttentionMode::kReference, proposals);
  at::set_num_threads(before);
  EXPECT_TRUE(at::equal(one, three));
}

TEST_F(AttentionTest, MapsHaveTheSizeOfTheirProposals) {
  for (const auto mode : {AttentionMode::kReference, AttentionMode::kOfficial}) {
    EXPECT_EQ(Maps(mode, {Noise(1, 50, 33), Noise(3, 50, 33)}).sizes(), (std::vector<int64_t>{2, 33, 50}));
    const Tensor upright = Maps(mode, {Noise(2, 31, 64)});
    EXPECT_EQ(upright.sizes(), (std::vector<int64_t>{1, 64, 31}));
    EXPECT_GT(upright.max().item<float>(), 0.f);
  }
}

TEST_F(AttentionTest, StopsWhenAskedTo) {
  RequestInterrupt(true);
  EXPECT_THROW(Maps(AttentionMode::kReference, proposals), Interrupted);
  RequestInterrupt(false);
}

TEST_F(AttentionTest, RefusesSettingsThatDoNotFit) {
  const std::vector<Image8> views = Beside(proposals);
  EXPECT_THROW(AttentionOn(aggregator, {.layers = {0}, .weights = {1, 2}}, views, {1}), ShapeError);
  EXPECT_THROW(AttentionOn(aggregator, {}, views, {}), ShapeError);
  EXPECT_THROW(AttentionOn(aggregator, {}, views, {3}), ShapeError);
  EXPECT_THROW(AttentionOn(aggregator, {}, views, {0}), ShapeError) << "the reference is fitted to the others";
  EXPECT_THROW(AttentionOn(aggregator, {}, {reference, Noise(1), Noise(2, 31, 64)}, {1, 2}), ShapeError);
}

TEST_F(AttentionTest, AnOfficialPassHoldsViewsOfAnySizeAndItsReferenceHasAMap) {
  const std::vector<Image8> views = {reference, Noise(1, 31, 64), proposals[0]};
  const AttentionSettings settings{AttentionMode::kOfficial, kWidth, {0, 2}, {0.25, 0.75}};
  const std::vector<Tensor> all = AttentionOn(aggregator, settings, views, {0, 1, 2});
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].sizes(), (std::vector<int64_t>{kHeight, kWidth}));
  EXPECT_EQ(all[1].sizes(), (std::vector<int64_t>{64, 31}));
  EXPECT_GT(at::cat({all[0].flatten(), all[1].flatten(), all[2].flatten()}).max().item<float>(), 0.3f);
  EXPECT_TRUE(at::equal(AttentionOn(aggregator, settings, views, {2})[0], all[2])) << "asking for fewer changes none";
}

TEST_F(AttentionTest, AnOpenedFileHasItsOwnSettings) {
  const TempDir dir;
  const auto path = WriteTinyVggt(dir / "tiny.safetensors");
  const auto network = OpenAttention(path, {AttentionMode::kReference}, torch::kCPU);
  const Camera small{40, 30, 50, 50, 20, 15, {}}, upright{30, 60, 50, 50, 15, 30, {}};
  const int64_t two = network->PassBytes({small}, 2), nine = network->PassBytes({small}, 9);
  EXPECT_GT(nine, two);
  EXPECT_LE(network->PassBytes({upright}, 2), two) << "only the shape counts: the longer side is always the same";
  EXPECT_GT(OpenAttention(path, {AttentionMode::kOfficial}, torch::kCPU)->PassBytes({small}, 2), two) << "padded";
  const std::vector<Buffer<float>> maps = network->Confidence(Beside(proposals), {2});
  const Tensor expected =
      AttentionOn(aggregator, {AttentionMode::kReference, 70, {0, 2}, {0.25, 0.75}}, Beside(proposals), {2})[0];
  ASSERT_EQ(maps.size(), 1u);
  ASSERT_EQ(maps[0].shape(), (Shape{kHeight, kWidth}));
  EXPECT_TRUE(std::equal(maps[0].span().begin(), maps[0].span().end(), expected.data_ptr<float>()));
}

TEST_F(AttentionTest, LayersAndWeightsMayBeAskedFor) {
  const TempDir dir;
  const auto path = WriteTinyVggt(dir / "tiny.safetensors");
  const auto maps_of = [&](const std::vector<LayerWeight>& layers) {
    const auto network = OpenAttention(path, {AttentionMode::kReference, layers}, torch::kCPU);
    const Buffer<float> map = network->Confidence(Beside(proposals), {1})[0];
    return std::vector<float>(map.span().begin(), map.span().end());
  };
  const auto of_file = maps_of({});
  EXPECT_EQ(maps_of({{0, 0.25}, {2, 0.75}}), of_file) << "what the file names";
  EXPECT_EQ(maps_of({{0, 1}, {2, 3}}), of_file) << "scaled to sum to 1";
  const auto first = maps_of({{0, 7}}), last = maps_of({{2, 0.1}});
  EXPECT_EQ(maps_of({{0, 2}, {1, 0}}), first) << "a layer of weight 0 counts nothing";
  EXPECT_NE(maps_of({{1, 1}}), first);
  ASSERT_EQ(first.size(), of_file.size());
  for (size_t i = 0; i < first.size(); i += 97) {
    EXPECT_NEAR(of_file[i], 0.25f * first[i] + 0.75f * last[i], 1e-5) << "the weighted mean of the layers' own maps";
  }
}

TEST_F(AttentionTest, LayersThatTheNetworkLacksAreRefused) {
  const TempDir dir;
  const auto path = WriteTinyVggt(dir / "tiny.safetensors");
  for (const int64_t layer : {int64_t{-1}, int64_t{4}}) {
    EXPECT_THAT(
        [&] {
          OpenAttention(path, {AttentionMode::kReference, {{layer, 1}}}, torch::kCPU);
        },
        ThrowsMessage<InputError>(
            testing::AllOf(HasSubstr("tiny.safetensors"), HasSubstr("only 0 to 3"), HasSubstr("--set vggt-layers"))));
  }
  EXPECT_THROW(OpenAttention(path, {AttentionMode::kReference, {{0, -1}}}, torch::kCPU), ShapeError);
  EXPECT_THROW(OpenAttention(path, {AttentionMode::kReference, {{0, 0}}}, torch::kCPU), ShapeError);
}

TEST_F(AttentionTest, WeightsThatDoNotFitAreRefusedWhenTheyAreLoaded) {
  const TempDir dir;
  const auto path = WriteTinyVggt(dir / "tiny.safetensors",
                                  [](TinyVggtParts* parts) { parts->tensors.erase("aggregator.camera_token"); });
  const auto network = OpenAttention(path, {AttentionMode::kReference}, torch::kCPU);
  EXPECT_THAT([&] { network->Load(); }, ThrowsMessage<InputError>(HasSubstr("missing 1: aggregator.camera_token")));
}

}  // namespace
}  // namespace oraclegs::vggt
