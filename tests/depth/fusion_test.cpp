#include "oraclegs/depth/fusion.h"

#include <gtest/gtest.h>

#include "depth/surfaces.h"

namespace oraclegs {
namespace {

constexpr size_t kPixels = 96 * 72;

std::vector<DepthMap> TrueDepths(const std::vector<LoadedView>& views, const TexturedPlane& surface,
                                 float confidence = 0.9f) {
  std::vector<DepthMap> maps;
  for (const LoadedView& view : views) maps.push_back(TrueDepth(view, surface, confidence));
  return maps;
}

double DistanceFrom(const TexturedPlane& surface, const DensePoint& point) {
  return std::abs((point.xyz.cast<double>() - surface.point).dot(surface.normal));
}

TEST(FuseDepth, MergesEqualViews) {
  const std::vector<LoadedView> one = TakeAll(kSlanted, Arc(1, 8)), two = {one[0], one[0]};
  const std::vector<DensePoint> points = FuseDepth(TrueDepths(two, kSlanted), two, {});
  ASSERT_EQ(points.size(), kPixels);
  for (size_t i = 0; i < kPixels; i += 97) {
    const DensePoint& p = points[i];
    EXPECT_EQ(p.views, 2);
    EXPECT_LT(DistanceFrom(kSlanted, p), 1e-4);
    EXPECT_NEAR(p.normal.norm(), 1, 1e-5);
    EXPECT_GT(p.normal.cast<double>().dot(kSlanted.normal), 0.9999) << "towards the cameras";
    const float* rgb = one[0].rgb.data.data() + 3 * i;
    EXPECT_LT((p.rgb - Eigen::Vector3f(rgb[0], rgb[1], rgb[2])).norm(), 1e-4);
    EXPECT_FLOAT_EQ(p.confidence, 0.9f);
    const Eigen::Vector3d in_camera = one[0].camera.cam_from_world * p.xyz.cast<double>();
    EXPECT_NEAR(p.pixel_size, in_camera.z() / one[0].camera.fx, 1e-4);
  }
}

TEST(FuseDepth, MakesOnePointPerPatch) {
  const std::vector<LoadedView> views = TakeAll(kSlanted, Arc(3, 6));
  const std::vector<DensePoint> points = FuseDepth(TrueDepths(views, kSlanted), views, {});
  EXPECT_GE(points.size(), kPixels);
  EXPECT_LT(points.size(), 1.7 * kPixels) << "three times as many pixels show it";
  size_t joined = 0;
  for (const DensePoint& p : points) {
    EXPECT_LT(DistanceFrom(kSlanted, p), 1e-3);
    joined += p.views > 1 ? 1 : 0;
  }
  EXPECT_GT(static_cast<double>(joined), 0.8 * static_cast<double>(kPixels));
}

TEST(FuseDepth, SkipsUnconfidentPixels) {
  const std::vector<LoadedView> views = TakeAll(kSlanted, Arc(1, 8));
  std::vector<DepthMap> maps = TrueDepths(views, kSlanted, 0.49f);
  EXPECT_TRUE(FuseDepth(maps, views, {}).empty());
  EXPECT_EQ(FuseDepth(maps, views, {.min_confidence = 0.4f}).size(), kPixels);
  maps[0].confidence[7] = 0.5f;
  EXPECT_EQ(FuseDepth(maps, views, {}).size(), 1u);
  EXPECT_TRUE(FuseDepth({}, {}, {}).empty());
}

/// As many maps of ten pixels, of which so many are confident.
std::vector<DepthMap> MapsOf(size_t views, int confident) {
  DepthMap map;
  for (int i = 0; i < 10; ++i) map.inv_depth.push_back(1), map.confidence.push_back(i < confident ? 0.6f : 0.3f);
  return std::vector<DepthMap>(views, map);
}

TEST(ConfidenceOfPoints, GrowsWithTheViewsThatCanAgree) {
  EXPECT_FLOAT_EQ(ConfidenceOfPoints(MapsOf(2, 5)), 0.2f);
  EXPECT_FLOAT_EQ(ConfidenceOfPoints(MapsOf(6, 5)), 0.2f);
  EXPECT_FLOAT_EQ(ConfidenceOfPoints(MapsOf(7, 5)), 0.35f);
  EXPECT_FLOAT_EQ(ConfidenceOfPoints(MapsOf(8, 5)), kConfident);
  EXPECT_FLOAT_EQ(ConfidenceOfPoints(MapsOf(40, 5)), kConfident);
}

TEST(ConfidenceOfPoints, IsNotLowWhereHardlyAnythingIsSure) {
  EXPECT_EQ(ConfidenceOfPoints(MapsOf(3, 1)), kConfident);
  EXPECT_LT(ConfidenceOfPoints(MapsOf(3, 2)), kConfident);
  std::vector<DepthMap> maps = MapsOf(2, 2);
  maps.emplace_back();  // not looked for
  EXPECT_LT(ConfidenceOfPoints(maps), kConfident);
  EXPECT_EQ(ConfidenceOfPoints({}), kConfident);
  maps.front().monocular = true;
  EXPECT_EQ(ConfidenceOfPoints(maps), kConfident) << "a network's depth is at most this sure";
}

TEST(FuseDepth, SeparatesDepths) {
  const std::vector<LoadedView> one = TakeAll(kSlanted, Arc(1, 8)), two = {one[0], one[0]};
  std::vector<DepthMap> maps = TrueDepths(two, kSlanted);
  for (float& w : maps[1].inv_depth) w *= 1.02f;
  const std::vector<DensePoint> points = FuseDepth(maps, two, {});
  EXPECT_EQ(points.size(), 2 * kPixels);
  for (const DensePoint& p : points) EXPECT_EQ(p.views, 1);
  EXPECT_EQ(FuseDepth(maps, two, {.max_depth_difference = 0.03f}).size(), kPixels);
}

TEST(FuseDepth, SeparatesOppositeNormals) {
  const std::vector<LoadedView> one = TakeAll(kSlanted, Arc(1, 8)), two = {one[0], one[0]};
  std::vector<DepthMap> maps = TrueDepths(two, kSlanted);
  for (Eigen::Vector3f& n : maps[1].normals) n = -n;
  EXPECT_EQ(FuseDepth(maps, two, {}).size(), 2 * kPixels);
}

TEST(FuseDepth, WeighsByConfidenceAndDistance) {
  const std::vector<LoadedView> one = TakeAll(kSlanted, Arc(1, 8));
  std::vector<LoadedView> two = {one[0], one[0]};
  for (float& value : two[0].rgb.data) value = 0;
  for (float& value : two[1].rgb.data) value = 1;
  std::vector<DepthMap> maps = TrueDepths(two, kSlanted, 0.9f);
  for (float& c : maps[1].confidence) c = 0.3f;  // joins, but would make no point
  const std::vector<DensePoint> points = FuseDepth(maps, two, {});
  ASSERT_EQ(points.size(), kPixels);
  EXPECT_NEAR(points[100].rgb.x(), 0.25, 1e-4);
  EXPECT_FLOAT_EQ(points[100].confidence, 0.9f);
}

TEST(FuseDepth, KeepsFinerPointsOfNearView) {
  const std::vector<Camera> cameras = {CameraAt({0, 0, -4}, {0, 0, 0}, 96, 72),
                                       CameraAt({0, 0, -1}, {0, 0, 0}, 96, 72)};
  const std::vector<LoadedView> views = TakeAll(kSlanted, cameras);
  const std::vector<DensePoint> points = FuseDepth(TrueDepths(views, kSlanted), views, {});
  EXPECT_GT(points.size(), 1.95 * kPixels) << "a few far pixels stand for many near ones";
}

TEST(FuseDepth, MeasuresImageDetail) {
  std::vector<LoadedView> views = TakeAll(kSlanted, Arc(1, 8));
  for (int y = 0; y < 72; ++y) {
    for (int x = 0; x < 96; ++x) {
      for (int c = 0; c < 3; ++c)
        views[0].rgb.row(y)[3 * x + c] = x < 40 ? 0.2f : x < 70 ? 0.6f : 0.6f + 0.02f * (x - 70);
    }
  }
  const std::vector<DensePoint> points = FuseDepth(TrueDepths(views, kSlanted), views, {});
  EXPECT_EQ(points[96 * 30 + 20].detail, 0);
  EXPECT_EQ(points[96 * 30 + 40].detail, 1) << "an edge";
  EXPECT_NEAR(points[96 * 30 + 80].detail, 0.4, 1e-4) << "0.04 over two pixels";
}

std::vector<DensePoint> Strewn(size_t n) {
  std::vector<DensePoint> points(n);
  for (size_t i = 0; i < n; ++i) {
    points[i].xyz = {static_cast<float>(i), 0, 0};
    points[i].detail = i % 2 == 0 ? 1 : 0;
  }
  return points;
}

std::vector<float> Chosen(const std::vector<DensePoint>& points) {
  std::vector<float> x;
  for (const DensePoint& p : points) x.push_back(p.xyz.x());
  return x;
}

TEST(Thinned, KeepsBudgetAndPrefersDetail) {
  const std::vector<DensePoint> points = Strewn(20000);
  const std::vector<DensePoint> thin = Thinned(points, 3000, 5);
  ASSERT_EQ(thin.size(), 3000u);
  const std::vector<float> chosen = Chosen(thin);
  EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
  EXPECT_TRUE(std::adjacent_find(chosen.begin(), chosen.end()) == chosen.end()) << "none twice";
  const auto detailed = std::count_if(thin.begin(), thin.end(), [](const DensePoint& p) { return p.detail == 1; });
  EXPECT_GT(detailed, 2600);  // eleven times as likely each
  EXPECT_LT(detailed, 2900) << "flat surfaces need points, too";
}

TEST(Thinned, DependsOnSeedOnly) {
  const std::vector<DensePoint> points = Strewn(2000);
  EXPECT_EQ(Chosen(Thinned(points, 100, 5)), Chosen(Thinned(points, 100, 5)));
  EXPECT_NE(Chosen(Thinned(points, 100, 5)), Chosen(Thinned(points, 100, 6)));
}

TEST(Thinned, KeepsSmallClouds) {
  const std::vector<DensePoint> points = Strewn(50);
  EXPECT_EQ(Chosen(Thinned(points, 50, 1)), Chosen(points));
  EXPECT_EQ(Chosen(Thinned(points, 5000, 1)), Chosen(points));
  EXPECT_EQ(Thinned(points, 49, 1).size(), 49u);
  EXPECT_TRUE(Thinned(points, 0, 1).empty());
  EXPECT_TRUE(Thinned({}, 10, 1).empty());
}

TEST(FuseDepth, SkipsViewsWithoutDepth) {
  const std::vector<LoadedView> views = TakeAll(kSlanted, Arc(3, 6));
  std::vector<DepthMap> maps = TrueDepths(views, kSlanted);
  const std::vector<DensePoint> two = FuseDepth({maps[0], maps[2]}, {views[0], views[2]}, {});
  maps[1] = {maps[1].name, maps[1].camera, {}, {}, {}};
  const std::vector<DensePoint> points = FuseDepth(maps, views, {});
  ASSERT_EQ(points.size(), two.size());
  for (size_t i = 0; i < points.size(); i += 89) EXPECT_EQ(points[i].xyz, two[i].xyz);
}

}  // namespace
}  // namespace oraclegs
