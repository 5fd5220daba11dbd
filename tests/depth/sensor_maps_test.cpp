#include "oraclegs/depth/sensor_maps.h"

#include <gmock/gmock.h>

#include "support/event_recorder.h"

namespace oraclegs {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

/// Maps of one pixel row whose depths are `depth`, and knowledge of all their pixels.
DepthMap Row(const std::vector<float>& depth, float confidence = 0.9f) {
  DepthMap map{"a", {static_cast<int>(depth.size()), 1, 10, 10, 5, 0.5}, {}, {}, {}};
  for (const float z : depth) {
    map.inv_depth.push_back(z > 0 ? 1 / z : 0);
    map.confidence.push_back(z > 0 ? confidence : 0);
    map.normals.emplace_back(0, 0, z > 0 ? -1 : 0);
  }
  return map;
}
std::vector<KnownDepth> Known(size_t n, double depth) {
  std::vector<KnownDepth> known;
  for (size_t i = 0; i < n; ++i) known.push_back({static_cast<double>(i) + 0.5, 0.5, 1 / depth});
  return known;
}

TEST(FitSensor, FindsTheScaleAmongWrongPoints) {
  std::vector<KnownDepth> known = Known(20, 2);
  for (size_t i = 0; i < 6; ++i) known[3 * i].inv_depth = 1 / 9.;
  const DepthMap map = Row(std::vector<float>(20, 4));
  const SensorFit fit = FitSensor({map, map}, {known, known});
  EXPECT_NEAR(fit.scale, 0.5, 1e-6);
  EXPECT_EQ(fit.checked, 2u);
  EXPECT_NEAR(fit.right, 14. / 20, 1e-9);
  EXPECT_TRUE(fit.is_usable);
}

TEST(FitSensor, NamesTheViewOfAnotherScale) {
  const DepthMap map = Row(std::vector<float>(20, 4)), other = Row(std::vector<float>(20, 5));
  const SensorFit fit = FitSensor({map, other, map}, {Known(20, 4), Known(20, 4), Known(20, 4)});
  EXPECT_THAT(fit.fits, testing::ElementsAre(true, false, true));
  EXPECT_NEAR(fit.scale, 1, 1e-6);
  EXPECT_TRUE(fit.is_usable);
}

TEST(FitSensor, IsNotUsableWithoutAgreement) {
  const DepthMap map = Row(std::vector<float>(20, 4));
  EXPECT_FALSE(FitSensor({map, map, map}, {Known(20, 2), Known(20, 4), Known(20, 8)}).is_usable);
  std::vector<KnownDepth> random = Known(20, 4);
  for (size_t i = 0; i < random.size(); ++i) random[i].inv_depth = 0.1 * static_cast<double>(i + 1);
  EXPECT_FALSE(FitSensor({map}, {random}).is_usable);
}

TEST(FitSensor, KeepsTheFilesScaleWithoutKnownDepths) {
  const SensorFit fit = FitSensor({Row(std::vector<float>(20, 4)), Row({})}, {Known(3, 2), {}});
  EXPECT_EQ(fit.checked, 0u);
  EXPECT_EQ(fit.scale, 1);
  EXPECT_TRUE(fit.is_usable);
}

TEST(WithSensorDepth, TakesWhatIsKnownElseWhatIsSurer) {
  DepthMap stereo = Row({2, 2, 0, 2, 2, 2, 2});
  stereo.confidence = {0.95f, 0.3f, 0, 0.95f, 0.8f, 0.8f, 0.3f};
  // Agrees; contradicts a doubtful one; fills; is unknown; contradicts a sure one, and does so beside an edge; agrees
  // with a doubtful one.
  DepthMap sensor = Row({4.1f, 6, 8, 0, 6, 6, 4.1f});
  sensor.confidence[5] = 0.45f;
  SensorFit fit;
  fit.scale = 0.5, fit.right = 0.8;
  double used = 0;
  const DepthMap map = WithSensorDepth(stereo, sensor, fit, {}, &used);
  const std::vector<float> depths = {2, 3, 4, 2, 3, 2, 2.05f};
  const std::vector<float> confidences = {1 - 0.05f * 0.28f, 0.72f, 0.72f, 0.95f, 0.72f, 0.8f, 1 - 0.7f * 0.28f};
  for (size_t i = 0; i < depths.size(); ++i) {
    EXPECT_NEAR(1 / map.inv_depth[i], depths[i], 1e-5f) << i;
    EXPECT_NEAR(map.confidence[i], confidences[i], 1e-5f) << i;
  }
  EXPECT_NEAR(used, 4. / 7, 1e-9);
}

TEST(WithSensorDepth, StaysInsideTheMaskAndServesAlone) {
  double used = 0;
  DepthMap none = Row({});
  none.camera.width = 3;
  const DepthMap map = WithSensorDepth(none, Row({4, 4, 4}), {}, {1, 0, 1}, &used);
  ASSERT_EQ(map.size(), 3u);
  EXPECT_EQ(map.inv_depth[1], 0);
  EXPECT_EQ(map.confidence[1], 0);
  EXPECT_NEAR(map.inv_depth[2], 0.25f, 1e-6f);
  EXPECT_EQ(WithSensorDepth(Row({4}), Row({}), {}, {}, &used).inv_depth[0], 0.25f);
}

/// Two views of one row of 20 pixels at depth 4, with true points.
class CombineWithSensorTest : public testing::Test {
 protected:
  CombineWithSensorTest() {
    for (const char* name : {"a", "b"}) {
      Camera camera{20, 1, 10, 10, 10, 0.5};
      views.push_back({name, camera, {20, 1, 3, {}}, {}});
      for (int i = 0; i < 60; ++i) views.back().rgb.data.push_back(static_cast<float>(i % 7) / 7);
    }
    for (int i = 0; i < 40; ++i) points.push_back({{(i / 2 + 0.5 - 10) / 10 * 4, 0, 4}, {}, {0, 1}});
  }
  SensorMaps Combine(const std::vector<DepthMap>& sensor, std::vector<DepthMap> stereo) {
    for (size_t v = 0; v < 2; ++v) stereo[v].camera = views[v].camera;
    return CombineWithSensor({views, Silhouettes(views), points}, sensor, std::move(stereo), events.AsListener());
  }

  std::vector<LoadedView> views;
  std::vector<ScenePoint> points;
  EventRecorder events;
};

TEST_F(CombineWithSensorTest, FillsWhatStereoLeaves) {
  const DepthMap sensor = Row(std::vector<float>(20, 2)), nothing = Row(std::vector<float>(20, 0));
  const SensorMaps combined = Combine({sensor, sensor}, {nothing, Row({})});
  EXPECT_NEAR(combined.fit.scale, 2, 1e-6);
  EXPECT_EQ(combined.views, 2u);
  EXPECT_NEAR(combined.used, 1, 1e-9);
  for (const DepthMap& map : combined.maps) {
    ASSERT_EQ(map.size(), 20u);
    EXPECT_NEAR(map.inv_depth[7], 0.25f, 1e-6f);
  }
  EXPECT_THAT(events.warnings, IsEmpty());
}

TEST_F(CombineWithSensorTest, ScalesToStereoWithoutPoints) {
  points.clear();
  const DepthMap sensor = Row(std::vector<float>(20, 2)), stereo = Row(std::vector<float>(20, 3));
  EXPECT_NEAR(Combine({sensor, sensor}, {stereo, stereo}).fit.scale, 1.5, 1e-6);
  const SensorMaps unchecked = Combine({sensor, sensor}, {Row({}), Row({})});
  EXPECT_EQ(unchecked.fit.checked, 0u);
  EXPECT_NEAR(unchecked.maps[0].inv_depth[0], 0.5f, 1e-6f);
}

TEST_F(CombineWithSensorTest, SaysWhichViewsKeepStereo) {
  const DepthMap stereo = Row(std::vector<float>(20, 4), 0.3f), blind = Row(std::vector<float>(20, 0));
  SensorMaps combined = Combine({Row(std::vector<float>(20, 4)), blind}, {stereo, stereo});
  EXPECT_EQ(combined.views, 1u);
  EXPECT_EQ(combined.maps[1].confidence[0], 0.3f);
  EXPECT_THAT(events.warnings, Contains(HasSubstr("the sensor's depth of a is all unknown")));
  combined = Combine({Row(std::vector<float>(20, 2)), Row(std::vector<float>(20, 9))}, {stereo, stereo});
  EXPECT_EQ(combined.views, 0u);
  EXPECT_EQ(combined.maps[0].confidence[0], 0.3f);
  EXPECT_THAT(events.warnings, Contains(HasSubstr("the sensor's depth is not used")));
}

}  // namespace
}  // namespace oraclegs
