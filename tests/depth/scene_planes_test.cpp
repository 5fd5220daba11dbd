#include "oraclegs/depth/scene_planes.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

DensePoint PointAt(const Eigen::Vector3f& xyz, const Eigen::Vector3f& normal) {
  DensePoint point;
  point.xyz = xyz, point.normal = normal, point.pixel_size = 0.01f;
  return point;
}

/// A grid on z = depth, facing -z.
void AddWall(float depth, int side, std::vector<DensePoint>* points) {
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      points->push_back(PointAt({0.1f * static_cast<float>(x), 0.1f * static_cast<float>(y), depth}, {0, 0, -1}));
    }
  }
}

TEST(FindPlanes, FindsLargestFirstAndIgnoresScatter) {
  std::vector<DensePoint> points;
  AddWall(3, 30, &points);
  AddWall(5, 40, &points);
  for (int i = 0; i < 40; ++i) {  // off every plane by more than five pixels, or turned away from it
    points.push_back(PointAt({0.07f * static_cast<float>(i), 0.3f, 6 + 0.2f * static_cast<float>(i)}, {0, 0, -1}));
    points.push_back(PointAt({0.07f * static_cast<float>(i), 0.5f, 3}, {1, 0, 0}));
  }
  const std::vector<ScenePlane> planes = FindPlanes(points);
  ASSERT_GE(planes.size(), 2u);
  EXPECT_NEAR(planes[0].Distance({1, 2, 5}), 0, 1e-4);
  EXPECT_NEAR(planes[1].Distance({1, 2, 3}), 0, 1e-4);
  EXPECT_NEAR(planes[0].normal.z(), -1, 1e-4);
  for (size_t p = 2; p < planes.size(); ++p) {
    EXPECT_LT(std::abs(planes[p].normal.z()), 0.9) << "no wall is found twice";
  }
}

TEST(FindPlanes, NeedsEnoughPoints) {
  std::vector<DensePoint> points;
  AddWall(3, 20, &points);
  EXPECT_TRUE(FindPlanes(points).empty());
}

}  // namespace
}  // namespace oraclegs
