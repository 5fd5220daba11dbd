#include "oraclegs/depth/stereo.h"

#include <gmock/gmock.h>

#include <variant>

#include "depth/surfaces.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/depth/plane_search.h"
#include "support/event_recorder.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;
using testing::Not;

StereoOptions Quick() {
  StereoOptions options;
  options.iterations = 4;
  options.geometric_passes = 1;
  return options;
}

std::vector<DepthMap> OnCpu(const std::vector<LoadedView>& views, const std::vector<ScenePoint>& points,
                            const StereoOptions& options, const Listener& listener) {
  return EstimateDepth(views, points, options, MakePlaneSearch(kCpu).get(), listener);
}

double MedianError(const DepthMap& map, const TexturedPlane& surface, float least_confidence = kConfident) {
  const PlaneMap truth = TrueMap(map.camera, surface);
  std::vector<double> errors;
  for (size_t i = 0; i < map.size(); ++i) {
    if (map.confidence[i] < least_confidence) continue;
    errors.push_back(std::abs(truth.planes[i].inv_depth / map.inv_depth[i] - 1));
  }
  if (errors.empty()) return 1;
  std::nth_element(errors.begin(), errors.begin() + static_cast<int64_t>(errors.size() / 2), errors.end());
  return errors[errors.size() / 2];
}

void ExpectConsistent(const DepthMap& map) {
  ASSERT_EQ(map.size(), static_cast<size_t>(map.camera.width * map.camera.height));
  ASSERT_EQ(map.normals.size(), map.size());
  ASSERT_EQ(map.confidence.size(), map.size());
  for (size_t i = 0; i < map.size(); ++i) {
    ASSERT_TRUE(map.confidence[i] >= 0 && map.confidence[i] <= 1);
    ASSERT_EQ(map.inv_depth[i] > 0, map.confidence[i] > 0);
    ASSERT_NEAR(map.normals[i].norm(), map.confidence[i] > 0 ? 1 : 0, 1e-5);
  }
}

TEST(EstimateDepth, FindsSlantedPlane) {
  EventRecorder events;
  const std::vector<LoadedView> views = TakeAll(kSlanted, Arc(4, 8));
  const std::vector<DepthMap> maps = OnCpu(views, {}, Quick(), events.AsListener());
  ASSERT_EQ(maps.size(), 4u);
  for (size_t v = 0; v < 4; ++v) {
    EXPECT_EQ(maps[v].name, views[v].name);
    ExpectConsistent(maps[v]);
    EXPECT_GT(ConfidentShare(maps[v]), 0.75) << v;
    EXPECT_LT(MedianError(maps[v], kSlanted), 0.01) << v;
    EXPECT_LT(MedianError(maps[v], kSlanted, 1e-6f), 0.01) << v << ", of all pixels";
    const Eigen::Vector3f normal = (views[v].camera.cam_from_world.linear() * kSlanted.normal).cast<float>();
    EXPECT_GT(maps[v].normals[36 * 96 + 48].dot(normal), 0.9) << v;
  }
  EXPECT_TRUE(events.warnings.empty());
  ASSERT_FALSE(events.steps.empty());
  for (size_t k = 0; k < events.steps.size(); ++k) {
    EXPECT_EQ(events.steps[k].stage, "depth");
    EXPECT_EQ(events.steps[k].done, static_cast<int64_t>(k + 1));
    EXPECT_EQ(events.steps[k].total, static_cast<int64_t>(events.steps.size()));
  }
}

TEST(EstimateDepth, GoesFromCoarseToFine) {
  EventRecorder events;
  const std::vector<DepthMap> maps = OnCpu(TakeAll(kSlanted, Arc(3, 8, 161, 121)), {}, Quick(), events.AsListener());
  ASSERT_EQ(maps.size(), 3u);
  ExpectConsistent(maps[1]);
  EXPECT_GT(ConfidentShare(maps[1]), 0.8);
  EXPECT_LT(MedianError(maps[1], kSlanted), 0.005);
  ASSERT_EQ(events.steps.size(), 9u);  // the search and one pass at half size, one at full size
  EXPECT_EQ(events.steps[0].detail, "80 x 60");
  EXPECT_EQ(events.steps[8].detail, "161 x 121");
  EXPECT_EQ(events.steps[8].total, 9);
}

/// Search that records the passes and improves nothing.
class PassRecorder final : public PlaneSearch {
 public:
  void BeginLevel(const StereoScene&, std::vector<PlaneMap> maps) override { maps_ = std::move(maps); }
  void BeginPass(const SearchPass& pass) override { passes.push_back(pass); }
  void Improve(size_t) override {}
  std::vector<PlaneMap> EndLevel() override { return std::move(maps_); }

  std::vector<SearchPass> passes;

 private:
  std::vector<PlaneMap> maps_;
};

TEST(EstimateDepth, SearchesNearCoarsePlanesInLargeImages) {
  const auto is_local = [](int width, int height) {
    PassRecorder search;
    EventRecorder events;
    EstimateDepth(TakeAll(kSlanted, Arc(3, 8, width, height)), {}, Quick(), &search, events.AsListener());
    EXPECT_EQ(search.passes.size(), 3u);
    EXPECT_FALSE(search.passes.at(0).local || search.passes.at(1).local) << "there is no coarser map";
    return search.passes.at(2).local;
  };
  EXPECT_TRUE(is_local(320, 240));
  EXPECT_FALSE(is_local(320, 238));
}

TEST(EstimateDepth, RunsWithoutGeometricPasses) {
  StereoOptions options = Quick();
  options.geometric_passes = 0;
  EventRecorder events;
  const std::vector<DepthMap> maps = OnCpu(TakeAll(kSlanted, Arc(3, 8, 160, 120)), {}, options, events.AsListener());
  EXPECT_EQ(events.steps.size(), 3u);
  EXPECT_EQ(events.steps.back().total, 3);
  ExpectConsistent(maps[1]);
  EXPECT_LT(MedianError(maps[1], kSlanted), 0.02);
}

TEST(EstimateDepth, IsUnconfidentWithoutTexture) {
  for (const float contrast : {0.f, 0.003f}) {
    std::vector<LoadedView> views = TakeAll(kSlanted, Arc(4, 8));
    for (LoadedView& view : views) {
      for (float& value : view.rgb.data) value = 0.5f + contrast * (value - 0.5f);
    }
    for (const DepthMap& map : OnCpu(views, {}, Quick(), Silent())) EXPECT_LT(ConfidentShare(map), 0.02);
  }
}

TEST(EstimateDepth, WarnsOfIsolatedViews) {
  std::vector<Camera> cameras = Arc(3, 8);
  cameras.push_back(CameraAt({0, 0, -4}, {0, 0, -90}, 96, 72));
  EventRecorder events;
  const std::vector<DepthMap> maps = OnCpu(TakeAll(kSlanted, cameras), {}, Quick(), events.AsListener());
  ASSERT_EQ(events.warnings.size(), 1u);
  EXPECT_THAT(events.warnings[0], testing::AllOf(HasSubstr("p3.png"), Not(HasSubstr("p0.png"))));
  EXPECT_EQ(ConfidentShare(maps[3]), 0);
  EXPECT_GT(ConfidentShare(maps[1]), 0.7) << "the others do not suffer";
}

TEST(EstimateDepth, WarnsOfPureRotation) {
  const Camera camera = CameraAt({0, 0, -4}, {0, 0, 0}, 96, 72);
  EventRecorder events;
  const std::vector<DepthMap> maps = OnCpu(TakeAll(kSlanted, {camera, camera}), {}, Quick(), events.AsListener());
  ASSERT_EQ(events.warnings.size(), 1u);
  EXPECT_THAT(events.warnings[0], testing::AllOf(HasSubstr("same point"), HasSubstr("p0.png, p1.png")));
  for (const DepthMap& map : maps) {
    ExpectConsistent(map);
    EXPECT_EQ(ConfidentShare(map), 0);
  }
}

TEST(EstimateDepth, KnowsNothingFromOneView) {
  EXPECT_TRUE(OnCpu({}, {}, Quick(), Silent()).empty());
  EventRecorder events;
  const std::vector<DepthMap> maps = OnCpu(TakeAll(kSlanted, Arc(1, 8)), {}, Quick(), events.AsListener());
  ASSERT_EQ(maps.size(), 1u);
  EXPECT_EQ(ConfidentShare(maps[0]), 0);
  EXPECT_EQ(events.warnings.size(), 1u);
}

TEST(EstimateDepth, LeavesBackgroundUnknown) {
  TexturedPlane square = kSlanted;
  square.half_side = 0.75;
  const std::vector<LoadedView> views = TakeAll(square, Arc(4, 8));
  const std::vector<DepthMap> maps = OnCpu(views, {}, Quick(), Silent());
  const PlaneMap truth = TrueMap(views[1].camera, square);
  size_t object = 0, confident = 0;
  for (size_t i = 0; i < maps[1].size(); ++i) {
    if (truth.planes[i].inv_depth > 0) {
      ++object;
      confident += maps[1].confidence[i] >= kConfident ? 1 : 0;
    } else {
      EXPECT_EQ(maps[1].inv_depth[i], 0) << i;
    }
  }
  EXPECT_GT(static_cast<double>(confident), 0.7 * static_cast<double>(object));
  EXPECT_LT(MedianError(maps[1], square), 0.01);
}

TEST(EstimateDepth, LeavesMaskedPixelsUnknown) {
  std::vector<LoadedView> views = TakeAll(kSlanted, Arc(3, 8));
  views[1].mask.assign(96 * 72, 1);
  for (size_t i = 0; i < 2000; ++i) views[1].mask[i] = 0;
  const std::vector<DepthMap> maps = OnCpu(views, {}, Quick(), Silent());
  for (size_t i = 0; i < 2000; ++i) EXPECT_EQ(maps[1].inv_depth[i], 0);
  EXPECT_GT(ConfidentShare(maps[1]), 0.4);
}

TEST(EstimateDepth, UsesDistancesOfPoints) {
  // Parallel axes tell nothing of distances.
  std::vector<Camera> cameras;
  for (const double x : {-0.2, 0.0, 0.2}) cameras.push_back(CameraAt({x, 0, 0}, {x, 0, 50}, 96, 72));
  const TexturedPlane wall{{0, 0, 1.6}, Eigen::Vector3d(0.2, 0, -1).normalized()};
  std::vector<ScenePoint> points;
  for (int i = 0; i < 60; ++i) {
    const double x = 0.1 * (i % 10 - 4.5), y = 0.1 * (i / 10 - 2.5);
    points.push_back({{x, y, 1.6 + 0.2 * x}, {}, {0, 1, 2}});
  }
  const std::vector<LoadedView> views = TakeAll(wall, cameras);
  const std::vector<DepthMap> maps = OnCpu(views, points, Quick(), Silent());
  EXPECT_GT(ConfidentShare(maps[1]), 0.6);
  EXPECT_LT(MedianError(maps[1], wall), 0.01);
}

class EstimateDepthThreads : public testing::Test {
 protected:
  ~EstimateDepthThreads() override { SetNumThreads(before_); }

 private:
  int before_ = NumThreads();
};

TEST_F(EstimateDepthThreads, GiveSameBits) {
  const std::vector<LoadedView> views = TakeAll(kSlanted, Arc(3, 8, 64, 48));
  StereoOptions options = Quick();
  options.iterations = 2;
  SetNumThreads(1);
  const std::vector<DepthMap> one = OnCpu(views, {}, options, Silent());
  SetNumThreads(3);
  const std::vector<DepthMap> three = OnCpu(views, {}, options, Silent());
  for (size_t v = 0; v < one.size(); ++v) {
    EXPECT_EQ(one[v].inv_depth, three[v].inv_depth);
    EXPECT_EQ(one[v].normals, three[v].normals);
    EXPECT_EQ(one[v].confidence, three[v].confidence);
  }
}

}  // namespace
}  // namespace oraclegs
