#include "oraclegs/stages/monocular_depth.h"

#include "oraclegs/core/interrupt.h"
#include "run/fixtures.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/network_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kWidth = 40, kHeight = 30;

float InvDepth(int x, int y) { return 0.25f + 0.005f * static_cast<float>(x) + 0.002f * static_cast<float>(y); }

/// Views from one place, of a surface whose inverse depth is a slope; the network predicted it in units of its
/// own.
class MonocularDepthTest : public testing::Test {
 protected:
  void SetUp() override {
    for (int v = 0; v < 3; ++v) {
      const Camera camera{kWidth, kHeight, 40, 40, kWidth / 2., kHeight / 2., Eigen::Isometry3d::Identity()};
      views.push_back({fmt::format("p{}.png", v), camera, {kWidth, kHeight, 3, {}}, {}});
      views.back().rgb.data.assign(kWidth * kHeight * 3, 0.5f);
      for (size_t i = 0; i < views.back().rgb.data.size(); ++i) {
        views.back().rgb.data[i] = static_cast<float>(i % 97) / 97;  // no plain background
      }
      DepthMap map{views.back().name, camera, {}, {}, {}};
      predicted.push_back({kWidth, kHeight, {}});
      for (int i = 0; i < kWidth * kHeight; ++i) {
        const float w = InvDepth(i % kWidth, i / kWidth);
        predicted.back().values.push_back((w - 0.1f) / static_cast<float>(2 + v));
        map.inv_depth.push_back(w);
        map.normals.emplace_back(0, 0, -1);
        map.confidence.push_back(i % kWidth < 20 ? 0.9f : 0.1f);
      }
      stereo.push_back(std::move(map));
    }
    for (int i = 0; i < 25; ++i) {
      const int x = 1 + 3 * i % 38, y = 1 + 7 * i % 28;
      const double z = 1 / static_cast<double>(InvDepth(x, y));
      points.push_back({{(x + 0.5 - kWidth / 2.) / 40 * z, (y + 0.5 - kHeight / 2.) / 40 * z, z}, {}, {0, 1, 2}});
    }
  }
  MonocularMaps Combine(bool fused) {
    return WithMonocularDepth({predicted, is_whole}, views, fused ? stereo : std::vector<DepthMap>(), points,
                              recorder.AsListener());
  }

  std::vector<LoadedView> views;
  std::vector<RelativeDepth> predicted;
  std::vector<DepthMap> stereo;
  std::vector<ScenePoint> points;
  EventRecorder recorder;
  bool is_whole = false;
};

TEST_F(MonocularDepthTest, AlignsEachViewToThePoints) {
  const MonocularMaps alone = Combine(false);
  EXPECT_NEAR(alone.right, 1, 1e-9);
  ASSERT_EQ(alone.maps.size(), 3u);
  for (const DepthMap& map : alone.maps) {
    EXPECT_EQ(map.confidence[77], 1);
    for (int i = 0; i < kWidth * kHeight; i += 50) {
      EXPECT_NEAR(map.inv_depth[static_cast<size_t>(i)], InvDepth(i % kWidth, i / kWidth), 1e-3);
    }
  }
  EXPECT_TRUE(recorder.warnings.empty());
}

TEST_F(MonocularDepthTest, FillsWhereStereoIsNotConfident) {
  const MonocularMaps fused = Combine(true);
  for (size_t v = 0; v < 3; ++v) {
    const DepthMap& map = fused.maps[v];
    EXPECT_EQ(map.confidence[5], stereo[v].confidence[5]);
    EXPECT_EQ(map.confidence[30], kMaxBesideStereo);
    EXPECT_NEAR(map.inv_depth[30], InvDepth(30, 0), 0.01);
  }
}

TEST_F(MonocularDepthTest, AMaskKeepsItsPixelsEmpty) {
  views[1].mask.assign(kWidth * kHeight, 1);
  views[1].mask[30] = 0;
  const MonocularMaps fused = Combine(true);
  EXPECT_EQ(fused.maps[1].confidence[30], 0);
  EXPECT_GT(fused.maps[1].confidence[31], 0);
}

TEST_F(MonocularDepthTest, WithTooFewPointsStereoAligns) {
  points.resize(3);
  const MonocularMaps fused = Combine(true);
  EXPECT_NEAR(fused.maps[0].inv_depth[30], InvDepth(30, 0), 0.01);
  EXPECT_TRUE(recorder.warnings.empty());
  const MonocularMaps alone = Combine(false);
  EXPECT_EQ(ConfidentShare(alone.maps[0]), 0);
  ASSERT_EQ(recorder.warnings.size(), 1u);
  EXPECT_THAT(recorder.warnings[0], testing::AllOf(HasSubstr("p0.png, p1.png, p2.png cannot be aligned"),
                                                   HasSubstr("they have no depth (--depth-prior fused)")));
}

TEST_F(MonocularDepthTest, AScaleUnlikeTheOthersIsNotBelieved) {
  for (float& value : predicted[2].values) value /= 100;
  const MonocularMaps fused = Combine(true);
  EXPECT_FALSE(fused.maps[2].monocular);
  EXPECT_EQ(fused.maps[2].confidence, stereo[2].confidence);
  ASSERT_EQ(recorder.warnings.size(), 1u);
  EXPECT_THAT(recorder.warnings[0],
              testing::AllOf(HasSubstr("depth of p2.png cannot"), HasSubstr("only stereo is used there")));
}

TEST_F(MonocularDepthTest, ASmallSceneIsAlignedAsALargeOneIs) {
  for (ScenePoint& point : points) point.xyz *= 1e5;
  EXPECT_NEAR(Combine(false).maps[0].inv_depth[30] * 1e5, InvDepth(30, 0), 1e-3);
}

TEST(DepthNetworkLicense, OnlyTheSmallNetworkIsForAnyUse) {
  EXPECT_FALSE(IsNonCommercialDepthNetwork("Depth Anything V2 small"));
  EXPECT_TRUE(IsNonCommercialDepthNetwork("Depth Anything V2 base"));
  EXPECT_TRUE(IsNonCommercialDepthNetwork("Depth Anything V2 large"));
}

TEST_F(MonocularDepthTest, TheNetworkPredictsEachViewAtItsSize) {
  SKIP_WITHOUT_NETWORKS();
  const TempDir temp;
  const auto weights = WriteTinyDepthAnything(temp / "tiny.safetensors");
  int64_t steps = 0;
  const std::vector<RelativeDepth> found = PredictRelativeDepth(weights, views, [&](const Event& event) {
    const auto* step = std::get_if<StepDone>(&event);
    ASSERT_TRUE(step);
    EXPECT_EQ(step->done, ++steps);
  });
  EXPECT_EQ(steps, 3);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].width, kWidth);
  EXPECT_EQ(found[0].height, kHeight);
  ASSERT_EQ(found[0].values.size(), static_cast<size_t>(kWidth * kHeight));
  EXPECT_EQ(found[0].values, found[1].values) << "the same image";
  EXPECT_NE(found[0].values[0], found[0].values[700]);
  RequestInterrupt(true);
  EXPECT_THROW(PredictRelativeDepth(weights, views, Silent()), Interrupted);
  RequestInterrupt(false);
  EXPECT_THAT(
      MessageOf<InputError>([&] { PredictRelativeDepth(WriteTinyLpips(temp / "x.safetensors"), views, Silent()); }),
      HasSubstr("is no Depth Anything V2"));
}

}  // namespace
}  // namespace oraclegs
