#include "oraclegs/stages/start_points.h"

#include <algorithm>

#include "depth/surfaces.h"
#include "run/fixtures.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class StartPointsTest : public testing::Test {
 protected:
  /// A run whose scene is a model with n points, each seen by all views.
  oraclegs::Run MakeRun(int n) {
    auto run = StartRun(request, recorder.AsListener());
    run.scene.points = Points(n);
    for (ScenePoint& point : run.scene.points) {
      for (size_t v = 0; v < run.scene.views.size(); ++v) point.views.push_back(static_cast<int>(v));
    }
    return run;
  }

  /// n points on the x axis, 0.01 apart.
  static std::vector<ScenePoint> Points(int n) {
    std::vector<ScenePoint> points(static_cast<size_t>(n));
    for (int i = 0; i < n; ++i) points[static_cast<size_t>(i)].xyz = {0.01 * i, 0, 0};
    return points;
  }

  /// Geometry like that of stereo: points of the plane z = 7 that face -z.
  static Geometry Dense(int n) {
    Geometry geometry;
    for (int i = 0; i < n; ++i) {
      DensePoint point;
      point.xyz = {0.01f * static_cast<float>(i), 0, 7};
      point.normal = {0, 0, -1};
      point.rgb = {0.1f, 0.2f, 0.3f};
      point.confidence = 1;
      geometry.points.push_back(point);
    }
    return geometry;
  }

  static StartPoints Choose(oraclegs::Run* run, const std::vector<ScenePoint>& sfm, const Geometry& geometry) {
    return ChooseStart(run, {{}, sfm, geometry});
  }

  static size_t CountDense(const PointCloud& cloud) {
    return static_cast<size_t>(
        std::count_if(cloud.xyz.begin(), cloud.xyz.end(), [](const auto& p) { return p.z() == 7; }));
  }

  TempDir temp;
  RunRequest request = TinyRequest(MakeTinyScene(temp / "scene"), temp / "out");  // budget 500, 400 random points
  EventRecorder recorder;
};

TEST_F(StartPointsTest, TakesRandomPointsWhenAskedTo) {
  request.options.train.depth_weight = 0;
  auto run = MakeRun(500);
  const StartPoints start = Choose(&run, {}, {});
  EXPECT_EQ(start.source, "random");
  EXPECT_EQ(start.cloud.xyz.size(), 400u);
  EXPECT_EQ(run.workspace.Record("start").at("source"), "random");
  EXPECT_EQ(run.workspace.Record("start").at("points"), 400);
  EXPECT_TRUE(recorder.warnings.empty());
}

TEST_F(StartPointsTest, DrawsFromTheDensePoints) {
  request.options.start.init = StartKind::kDense;
  auto run = MakeRun(0);
  const StartPoints start = Choose(&run, Points(300), Dense(2000));
  EXPECT_EQ(start.source, "dense");
  ASSERT_EQ(start.cloud.xyz.size(), 500u);
  ASSERT_EQ(start.cloud.rgb.size(), 500u);
  EXPECT_EQ(CountDense(start.cloud), 500u);
  EXPECT_EQ(start.cloud.rgb[17], Eigen::Vector3f(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(Choose(&run, Points(300), Dense(2000)).cloud.xyz, start.cloud.xyz);
  run.options.start.seed = 1;
  EXPECT_NE(Choose(&run, Points(300), Dense(2000)).cloud.xyz, start.cloud.xyz);
}

TEST(DenseStart, ExtrapolatesPlanes) {
  const TexturedPlane wall{{0, 0, 0.3}, Eigen::Vector3d(0.4, -0.3, -1).normalized()};
  const std::vector<LoadedView> photos = TakeAll(wall, Arc(3, 6));
  Geometry geometry;
  for (const LoadedView& photo : photos) {
    geometry.maps.push_back(TrueDepth(photo, wall, 0.9f));
    DepthMap& map = geometry.maps.back();
    for (size_t i = 30 * 96; i < 40 * 96; ++i) map.confidence[i] = 0;
  }
  geometry.points = FuseDepth(geometry.maps, photos, {});
  StartOptions options;
  const size_t all = DenseStart(options, photos, geometry, 1000000).xyz.size();
  options.init_planes = false;
  EXPECT_EQ(DenseStart(options, photos, geometry, 1000000).xyz.size(), geometry.points.size());
  EXPECT_GT(all, geometry.points.size() + 100);
  EXPECT_EQ(DenseStart(options, photos, geometry, 500).xyz.size(), 500u);
}

TEST(DenseStart, AddsWhatANetworkPredictsInTheRest) {
  const TexturedPlane wall{{0, 0, 0.3}, Eigen::Vector3d(0.4, -0.3, -1).normalized()};
  const std::vector<LoadedView> photos = TakeAll(wall, Arc(3, 6));
  Geometry geometry;
  for (const LoadedView& photo : photos) {
    geometry.maps.push_back(TrueDepth(photo, wall, 0.9f));
    DepthMap& map = geometry.maps.back();
    map.monocular = true;
    for (size_t i = 30 * 96; i < 40 * 96; ++i) map.confidence[i] = 0.3f;
  }
  geometry.points = FuseDepth(geometry.maps, photos, {});
  StartOptions options;
  const size_t with_planes = DenseStart(options, photos, geometry, 1000000).xyz.size();
  options.init_planes = false;
  const size_t without = DenseStart(options, photos, geometry, 1000000).xyz.size();
  EXPECT_GT(without, geometry.points.size() + 50);
  for (DepthMap& map : geometry.maps) map.monocular = false;
  EXPECT_EQ(DenseStart(options, photos, geometry, 1000000).xyz.size(), geometry.points.size());
  options.init_planes = true;
  const size_t planes = DenseStart(options, photos, geometry, 1000000).xyz.size();
  EXPECT_LT(with_planes - planes, (without - geometry.points.size()) / 2)
      << "planes come first, nothing is filled twice";
}

TEST_F(StartPointsTest, RefusesPointsThatAreNotThere) {
  request.options.start.init = StartKind::kDense;
  auto run = MakeRun(0);
  EXPECT_THAT(MessageOf<InputError>([&] { Choose(&run, Points(300), Dense(3)); }),
              testing::AllOf(HasSubstr("stereo gave 3 points"), HasSubstr("--init sfm")));
  run.options.start.init = StartKind::kSfm;
  EXPECT_THAT(MessageOf<InputError>([&] { Choose(&run, Points(3), Dense(2000)); }),
              testing::AllOf(HasSubstr("gave 3 points"), HasSubstr("--init random")));
}

TEST_F(StartPointsTest, TakesEveryNthSparsePointBeyondTheBudget) {
  request.options.start.init = StartKind::kSfm;
  auto run = MakeRun(0);
  const StartPoints start = Choose(&run, Points(1000), Dense(2000));
  EXPECT_EQ(start.source, "sfm");
  ASSERT_EQ(start.cloud.xyz.size(), 500u);
  EXPECT_FLOAT_EQ(start.cloud.xyz[1].x(), 0.02f);  // every second one
  EXPECT_FLOAT_EQ(start.cloud.xyz[499].x(), 9.98f);
}

TEST_F(StartPointsTest, PrefersDensePoints) {
  request.options.start.init = {};
  auto run = MakeRun(0);
  EXPECT_EQ(Choose(&run, Points(300), Dense(1000)).source, "dense");
  EXPECT_TRUE(recorder.warnings.empty());
  EXPECT_EQ(Choose(&run, Points(1000), Dense(999)).source, "sfm");
  ASSERT_EQ(recorder.warnings.size(), 1u);
  EXPECT_THAT(recorder.warnings[0], HasSubstr("stereo gave 999 points only"));
}

TEST_F(StartPointsTest, JoinsFewSparsePointsByRandomOnes) {
  request.options.start.init = {};
  auto run = MakeRun(0);
  const StartPoints start = Choose(&run, Points(150), {});
  EXPECT_EQ(start.source, "sfm+random");
  ASSERT_EQ(start.cloud.xyz.size(), 500u);  // 400 random points were asked for, the budget is 500
  EXPECT_EQ(start.cloud.rgb.size(), 500u);
  EXPECT_FLOAT_EQ(start.cloud.xyz[149].x(), 1.49f);
}

TEST_F(StartPointsTest, FallsBackToRandomPointsWithAWarning) {
  request.options.start.init = {};
  auto run = MakeRun(0);
  const StartPoints start = Choose(&run, Points(99), {});
  EXPECT_EQ(start.source, "random");
  EXPECT_EQ(start.cloud.xyz.size(), 400u);
  ASSERT_FALSE(recorder.warnings.empty());
  EXPECT_THAT(recorder.warnings.back(), HasSubstr("fewer than 100"));
}

TEST_F(StartPointsTest, KeepsRoomForSparseAndRandomPointsInAHybridStart) {
  request.options.start.init = StartKind::kHybrid;
  auto run = MakeRun(0);
  const StartPoints start = Choose(&run, Points(200), Dense(2000));
  EXPECT_EQ(start.source, "dense+sfm+random");
  ASSERT_EQ(start.cloud.xyz.size(), 500u);
  EXPECT_EQ(CountDense(start.cloud), 250u);  // what 200 sparse and a tenth of random points leave
  EXPECT_EQ(start.cloud.xyz[250], Eigen::Vector3f(0, 0, 0)) << "the first sparse point";
  EXPECT_EQ(run.workspace.Record("start").at("source"), "dense+sfm+random");

  EXPECT_EQ(Choose(&run, {}, {}).source, "random") << "what there is";
  EXPECT_EQ(Choose(&run, Points(2000), Dense(2000)).cloud.xyz.size(), 500u) << "never more than the budget";
}

TEST_F(StartPointsTest, TakesPointsOfAFileInTheScenesCoordinates) {
  auto run = MakeRun(100);
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 600\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  for (int i = 0; i < 600; ++i) ply += std::to_string(i) + " 0 7\n";
  WriteFileAtomically(temp / "points.ply", ply);
  run.options.start.init_points = temp / "points.ply";
  const StartPoints start = Choose(&run, Points(100), Dense(100));
  EXPECT_EQ(start.source, "file");
  ASSERT_EQ(start.cloud.xyz.size(), 500u) << "the budget";
  const Eigen::Vector3d first = RunFromScene(run.frame) * Eigen::Vector3d(0, 0, 7);
  EXPECT_TRUE(start.cloud.xyz[0].isApprox(first.cast<float>()));
  WriteFileAtomically(temp / "points.ply", ply.replace(ply.find("600"), 3, "  2"));
  EXPECT_THAT(MessageOf<InputError>([&] { Choose(&run, {}, {}); }), HasSubstr("holds 2 points, too few"));
}

}  // namespace
}  // namespace oraclegs
