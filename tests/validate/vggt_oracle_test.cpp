#include "oraclegs/validate/vggt_oracle.h"

#include "networks/vggt_fixture.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

constexpr int kWidth = 84, kHeight = 56;

ImageF ToImage(const Tensor& chw) {
  const Tensor hwc = chw.permute({1, 2, 0}).contiguous();
  const float* values = hwc.data_ptr<float>();
  return {static_cast<int>(hwc.size(1)), static_cast<int>(hwc.size(0)), 3, {values, values + hwc.numel()}};
}

Camera CameraOf(int width, int height) { return {width, height, 60, 60, width / 2.0, height / 2.0}; }

class VggtOracleTest : public testing::Test {
 protected:
  VggtOracleTest() {
    const Tensor images = GoldenFloat(file, "input.images");
    photos.push_back({"photo", CameraOf(kWidth, kHeight), ToImage(images[0]), {}});
    for (int v = 1; v < 3; ++v) proposals.push_back(Make(ToImage(images[v])));
  }

  static Proposal Make(const ImageF& image) { return {"p", "warp", CameraOf(image.width, image.height), image}; }
  static Proposal Noise(uint64_t seed, int width = kWidth, int height = kHeight) {
    ImageF image{width, height, 3, {}};
    Rng rng(seed, RandomStream::kDemoScene);
    for (int i = 0; i < 3 * width * height; ++i) image.data.push_back(static_cast<float>(rng.Uniform()));
    return Make(image);
  }

  /// At the size of the fixture's images, which are not resized then.
  VggtOracle Oracle(AttentionMode mode, size_t chunk = 8, std::function<void(size_t)> looked = {}) const {
    return {GoldenVggt().aggregator, {mode, chunk, kWidth, {0, 2}, {0.25, 0.75}, std::move(looked)}, photos};
  }

  static double Difference(const ConfidenceMap& a, const ConfidenceMap& b) {
    double most = 0;
    for (size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(static_cast<double>(a[i] - b[i])));
    return a.size() == b.size() ? most : 1e9;
  }

  const SafetensorsFile file = OpenGolden(kVggtFixture);
  std::vector<LoadedView> photos;
  std::vector<Proposal> proposals;
};

TEST_F(VggtOracleTest, IsThePublishedMapButForTheRoundingOfPictures) {
  for (const auto& [mode, name] :
       {std::pair{AttentionMode::kOthers, "others"}, std::pair{AttentionMode::kReference, "reference"}}) {
    const auto maps = Oracle(mode).Validate(proposals);
    const Tensor golden = GoldenFloat(file, std::string("output.uncertainty.") + name);
    for (int v = 0; v < 2; ++v) {
      const Tensor want = golden[v + 1].contiguous();
      const float* values = want.data_ptr<float>();
      EXPECT_LT(Difference(maps[static_cast<size_t>(v)], {values, values + want.numel()}), 0.05) << name;
    }
  }
}

TEST_F(VggtOracleTest, ModesDifferInWhoseAttentionCounts) {
  const std::vector<Proposal> other = {proposals[0], Noise(5)};
  const auto reference = Oracle(AttentionMode::kReference), others = Oracle(AttentionMode::kOthers),
             official = Oracle(AttentionMode::kOfficial);
  const auto a = reference.Validate(proposals), b = others.Validate(proposals), c = official.Validate(proposals);
  EXPECT_GT(Difference(a[0], b[0]), 0.02);
  EXPECT_GT(Difference(a[0], c[0]), 0.02);
  EXPECT_GT(Difference(b[0], c[0]), 0.02);
  for (const auto* maps : {&a, &b, &c}) {
    for (const ConfidenceMap& map : *maps) {
      ASSERT_EQ(map.size(), size_t{kWidth} * kHeight);
      EXPECT_GE(*std::min_element(map.begin(), map.end()), 0.f);
      EXPECT_LE(*std::max_element(map.begin(), map.end()), 1.f);
    }
  }
  // The extremes of a view are its own, but for the official map, where they are those of all views of the pass.
  const auto range = [](const ConfidenceMap& map) {
    return *std::max_element(map.begin(), map.end()) - *std::min_element(map.begin(), map.end());
  };
  EXPECT_GT(range(a[0]), 0.4f);
  EXPECT_GT(range(b[1]), 0.4f);
  // What else is in the pass changes what its own attention is, and in "others" who looks.
  EXPECT_GT(Difference(others.Validate(other)[0], b[0]), 1e-3);
}

TEST_F(VggtOracleTest, PassesAreIndependentAndTold) {
  std::vector<Proposal> five = proposals;
  for (uint64_t s = 0; s < 3; ++s) five.push_back(Noise(s));
  std::vector<size_t> told;
  const auto oracle = Oracle(AttentionMode::kOthers, 2, [&](size_t n) { told.push_back(n); });
  const auto maps = oracle.Validate(five);
  EXPECT_EQ(told, (std::vector<size_t>{1, 2, 2}));  // even runs of at most two
  EXPECT_EQ(maps[0], oracle.Validate({five[0]})[0]);
  EXPECT_EQ(maps[2], oracle.Validate({five[1], five[2]})[1]);
  EXPECT_EQ(maps[4], oracle.Validate({five[3], five[4]})[1]);
  EXPECT_NE(maps[2], oracle.Validate({five[4], five[2]})[1]);
  EXPECT_EQ(maps, Oracle(AttentionMode::kOthers, 2).Validate(five));
}

TEST_F(VggtOracleTest, SameBitsForAnyNumberOfThreads) {
  const int before = at::get_num_threads();
  at::set_num_threads(1);
  const auto one = Oracle(AttentionMode::kReference).Validate(proposals);
  at::set_num_threads(3);
  const auto three = Oracle(AttentionMode::kReference).Validate(proposals);
  at::set_num_threads(before);
  EXPECT_EQ(one, three);
}

TEST_F(VggtOracleTest, MapsHaveTheSizeOfTheirProposals) {
  for (const auto mode : {AttentionMode::kReference, AttentionMode::kOfficial}) {
    const auto maps = Oracle(mode).Validate({Noise(1, 50, 33), Noise(2, 31, 64), Noise(3, 50, 33)});
    EXPECT_EQ(maps[0].size(), 50u * 33u);
    EXPECT_EQ(maps[1].size(), 31u * 64u);
    EXPECT_EQ(maps[2].size(), 50u * 33u);
    EXPECT_GT(*std::max_element(maps[1].begin(), maps[1].end()), 0.f);
  }
}

TEST_F(VggtOracleTest, AHiddenPhotographIsNotLookedAt) {
  photos.push_back({"second", CameraOf(kWidth, kHeight), Noise(9).rgb, {}});
  const auto oracle = Oracle(AttentionMode::kReference);
  const ConfidenceMap beside_first = oracle.Judge({{1, proposals[0]}})[0];
  const ConfidenceMap beside_second = oracle.Judge({{0, proposals[0]}})[0];
  EXPECT_NE(beside_first, beside_second);
  photos[1].rgb = Noise(10).rgb;
  EXPECT_EQ(oracle.Judge({{1, proposals[0]}})[0], beside_first);
  EXPECT_NE(oracle.Judge({{0, proposals[0]}})[0], beside_second);
  photos.pop_back();
  EXPECT_THROW(oracle.Judge({{0, proposals[0]}}), InputError);
}

TEST_F(VggtOracleTest, StopsWhenAskedTo) {
  const auto oracle = Oracle(AttentionMode::kReference);
  RequestInterrupt(true);
  EXPECT_THROW(oracle.Validate(proposals), Interrupted);
  RequestInterrupt(false);
  EXPECT_EQ(oracle.Validate(proposals).size(), 2u);
}

TEST_F(VggtOracleTest, RefusesOptionsThatDoNotFit) {
  EXPECT_THROW(VggtOracle(GoldenVggt().aggregator, {.layers = {0}, .weights = {1, 2}}, photos), ShapeError);
  EXPECT_THROW(Oracle(AttentionMode::kReference, 0), ShapeError);
}

}  // namespace
}  // namespace oraclegs
