#include "oraclegs/depth/stereo_setup.h"

#include <gmock/gmock.h>

#include "depth/surfaces.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

LoadedView Blank(const Camera& camera) {
  return {
      "blank", camera, {camera.width, camera.height, 3, std::vector<float>(camera.width * camera.height * 3, 1.f)}, {}};
}

std::vector<LoadedView> Blanks(const std::vector<Camera>& cameras) {
  std::vector<LoadedView> views;
  for (const Camera& camera : cameras) views.push_back(Blank(camera));
  return views;
}

/// Points in front of CameraAt({0, 0, -4}, 0) from depth `near` to `far`, seen by these views.
std::vector<ScenePoint> Points(int n, double near, double far, const std::vector<int>& views) {
  std::vector<ScenePoint> points;
  for (int i = 0; i < n; ++i) {
    ScenePoint point;
    point.xyz = {0.01 * (i % 7), 0.01 * (i % 5), near - 4 + (far - near) * i / (n - 1)};
    point.views = views;
    points.push_back(point);
  }
  return points;
}

/// A dark square in the middle of each image.
std::vector<LoadedView> Squares(const std::vector<Camera>& cameras) {
  std::vector<LoadedView> views = Blanks(cameras);
  for (LoadedView& view : views) {
    for (int y = 20; y < 50; ++y) {
      for (int x = 30; x < 60; ++x) view.rgb.row(y)[3 * x] = 0;
    }
  }
  return views;
}

TEST(AngleAt, IsInDegreesBetweenRays) {
  const Camera a = CameraAt({0, 0, -4}, {0, 0, 0}), b = CameraAt({4, 0, 0}, {0, 0, 0});
  EXPECT_NEAR(AngleAt({0, 0, 0}, a, b), 90, 1e-9);
  EXPECT_NEAR(AngleAt({0, 0, 0}, a, a), 0, 1e-5);
  EXPECT_NEAR(AngleAt({2, 0, -2}, a, b), 180, 1e-5);
}

TEST(FindDepthRanges, ContainPointsWithMargin) {
  const Camera camera = CameraAt({0, 0, -4}, {0, 0, 0}, 96, 72);
  const std::vector<LoadedView> views = Blanks({camera});
  const DepthRange range = FindDepthRanges(views, Points(1000, 3, 6, {0}), Silhouettes({}))[0];
  EXPECT_NEAR(1 / range.near, 0.3 * 3, 0.05);
  EXPECT_NEAR(1 / range.far, 2.5 * 6, 0.1);
  std::vector<ScenePoint> points = Points(1000, 3, 6, {0});
  for (int i = 0; i < 3; ++i) points[static_cast<size_t>(i)].xyz = {0, 0, i == 0 ? 1e6 : -3.99};  // outliers
  const DepthRange same = FindDepthRanges(views, points, Silhouettes({}))[0];
  EXPECT_NEAR(same.near, range.near, 0.02 * range.near);
  EXPECT_NEAR(same.far, range.far, 0.02 * range.far);
}

TEST(FindDepthRanges, UseCamerasWithFewPoints) {
  const std::vector<Camera> cameras = Arc(5, 10);
  for (const DepthRange& range : FindDepthRanges(Blanks(cameras), Points(19, 3, 6, {0, 1}), Silhouettes({}))) {
    EXPECT_NEAR(1 / range.near, 0.2 * 4, 0.05);
    EXPECT_NEAR(1 / range.far, 20 * 4, 1);
  }
  const DepthRange one = FindDepthRanges(Blanks({cameras[0]}), {}, Silhouettes({}))[0];
  EXPECT_TRUE(one.far > 0 && one.near > one.far);
}

TEST(FindDepthRanges, UseCamerasAndPointsWithSilhouettes) {
  const std::vector<LoadedView> views = Squares(Arc(4, 30));
  const Silhouettes silhouettes(views);
  ASSERT_FALSE(silhouettes.empty());
  for (const DepthRange& range : FindDepthRanges(views, Points(19, 1, 50, {0, 1, 2, 3}), silhouettes)) {
    EXPECT_NEAR(1 / range.near, 0.55 * 4, 0.05);
    EXPECT_NEAR(1 / range.far, 1.45 * 4, 0.1);
  }
  for (const DepthRange& range : FindDepthRanges(views, Points(500, 1, 50, {0, 1, 2, 3}), silhouettes)) {
    EXPECT_NEAR(1 / range.near, 0.55 * 4, 0.05);
    EXPECT_GT(1 / range.far, 1.8 * 4);
  }
}

TEST(FindNeighbors, PreferTenDegrees) {
  std::vector<Camera> cameras;
  for (const double angle : {0.0, 2.0, 10.0, 28.0, 85.0}) {
    const double radians = angle * M_PI / 180;
    cameras.push_back(CameraAt({4 * std::sin(radians), 0, -4 * std::cos(radians)}, {0, 0, 0}, 96, 72));
  }
  EXPECT_THAT(FindNeighbors(Blanks(cameras), {}, 8)[0], ElementsAre(2, 3, 1)) << "10, 28, 2; 85 is too wide";
  EXPECT_THAT(FindNeighbors(Blanks(cameras), {}, 2)[0], ElementsAre(2, 3));
}

TEST(FindNeighbors, AreLookedForOfWantedViewsAlone) {
  const std::vector<LoadedView> views = Blanks(Arc(5, 10));
  const std::vector<ScenePoint> points = Points(50, 3, 5, {0, 1, 2, 4});
  const auto all = FindNeighbors(views, points, 3),
             some = FindNeighbors(views, points, 3, [](size_t v) { return v < 2; });
  ASSERT_THAT(all, testing::Each(testing::Not(IsEmpty())));
  EXPECT_THAT(some, ElementsAre(all[0], all[1], IsEmpty(), IsEmpty(), IsEmpty()));
}

TEST(FindNeighbors, UseAngleAtSharedPoints) {
  std::vector<Camera> cameras;
  for (const double x : {0.0, 0.5, 1.0}) cameras.push_back(CameraAt({x, 0, 0}, {x, 0, 1}, 96, 72));
  std::vector<ScenePoint> points;
  for (int i = 0; i < 10; ++i) {
    points.push_back({{0.5 + 0.01 * i, 0, 5.7}, {}, {0, 1, 2}});  // half a unit away from here is 5 degrees
  }
  EXPECT_THAT(FindNeighbors(Blanks(cameras), points, 1)[0], ElementsAre(2));
  for (ScenePoint& point : points) point.xyz.z() = 2.8;  // and here 10 degrees
  EXPECT_THAT(FindNeighbors(Blanks(cameras), points, 1)[0], ElementsAre(1));
}

TEST(FindNeighbors, RejectPureRotation) {
  const std::vector<Camera> arc = Arc(2, 10);
  Camera moved = arc[0];
  moved.cam_from_world.translation().x() += 4 * 0.3 * M_PI / 180;  // 0.3 degrees
  const auto neighbors = FindNeighbors(Blanks({arc[0], arc[0], moved, arc[1]}), {}, 8);
  EXPECT_THAT(neighbors[0], ElementsAre(3));
  EXPECT_THAT(neighbors[1], ElementsAre(3));
  EXPECT_THAT(neighbors[2], ElementsAre(3));
  EXPECT_EQ(neighbors[3].size(), 3u);
  const auto lonely = FindNeighbors(Blanks({arc[0], arc[0]}), Points(50, 3, 5, {0, 1}), 8);
  EXPECT_THAT(lonely, ElementsAre(IsEmpty(), IsEmpty()));
}

TEST(FindNeighbors, AreNoneWithoutOverlap) {
  const std::vector<Camera> apart = {CameraAt({0, 0, -4}, {0, 0, -9}, 96, 72), CameraAt({0, 0, 4}, {0, 0, 9}, 96, 72)};
  EXPECT_THAT(FindNeighbors(Blanks(apart), {}, 5), ElementsAre(IsEmpty(), IsEmpty()));
  EXPECT_THAT(FindNeighbors(Blanks({apart[0]}), {}, 5), ElementsAre(IsEmpty()));
}

TEST(ViewsForStereo, AreAllOfFew) {
  const std::vector<size_t> views = ViewsForStereo(Arc(static_cast<int>(kMaxStereoViews), 2));
  ASSERT_EQ(views.size(), kMaxStereoViews);
  for (size_t v = 0; v < views.size(); ++v) EXPECT_EQ(views[v], v);
}

TEST(ViewsForStereo, AreSpreadEvenly) {
  const std::vector<Camera> cameras = Arc(127, 1.5);
  const std::vector<size_t> views = ViewsForStereo(cameras);
  ASSERT_EQ(views.size(), kMaxStereoViews);
  EXPECT_EQ(views.front(), 0u);
  EXPECT_GE(views.back(), 122u);
  for (size_t k = 1; k < views.size(); ++k) {
    EXPECT_GE(views[k] - views[k - 1], 1u);
    EXPECT_LE(views[k] - views[k - 1], 8u);
  }
}

TEST(ViewsForStereo, LeaveOutRepeatedPoses) {
  std::vector<Camera> cameras(2 * kMaxStereoViews, CameraAt({0, 0, -4}, {0, 0, 0}));
  cameras[7] = CameraAt({1, 0, -4}, {0, 0, 0});
  EXPECT_THAT(ViewsForStereo(cameras), ElementsAre(0, 7));
}

}  // namespace
}  // namespace oraclegs
