#include "oraclegs/mesh/charts.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

namespace oraclegs {
namespace {

/// The six sides of a cube of side 2, two triangles each, which share their corners' vertices.
TriangleMesh Cube() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.emplace_back(static_cast<float>(2 * (i & 1)), static_cast<float>(i & 2),
                                static_cast<float>((i & 4) / 2));
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  SetNormals(&mesh);
  return mesh;
}

TEST(Charts, AreTheSidesOfACube) {
  const std::vector<Chart> charts = ChartsOf(Cube());
  ASSERT_EQ(charts.size(), 6u);
  for (const Chart& chart : charts) {
    EXPECT_EQ(chart.corners.size(), 2u);
    ASSERT_EQ(chart.places.size(), 4u);
    EXPECT_EQ(chart.vertices.size(), 4u);
  }
}

TEST(Charts, KeepLengthsAndOrientation) {
  TriangleMesh mesh;  // a long rectangle at an angle
  const Eigen::Matrix3f turn = Eigen::AngleAxisf(0.7f, Eigen::Vector3f(1, 2, 3).normalized()).toRotationMatrix();
  for (const auto& [x, y] : {std::pair(0.f, 0.f), {5.f, 0.f}, {5.f, 1.f}, {0.f, 1.f}}) {
    mesh.positions.emplace_back(turn * Eigen::Vector3f(x, y, 0));
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  SetNormals(&mesh);
  const std::vector<Chart> charts = ChartsOf(mesh);
  ASSERT_EQ(charts.size(), 1u);
  const Chart& chart = charts[0];
  EXPECT_GT(chart.size.x(), chart.size.y());
  for (const auto& t : chart.corners) {
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = t[k], b = t[(k + 1) % 3];
      EXPECT_NEAR((chart.places[a] - chart.places[b]).norm(),
                  (mesh.positions[chart.vertices[a]] - mesh.positions[chart.vertices[b]]).norm(), 1e-5);
    }
    const Eigen::Vector2f p = chart.places[t[1]] - chart.places[t[0]], q = chart.places[t[2]] - chart.places[t[0]];
    EXPECT_GT(p.x() * q.y() - p.y() * q.x(), 0);
  }
  for (const Eigen::Vector2f& place : chart.places) EXPECT_GE(place.minCoeff(), 0);
}

TEST(Charts, EndWhereThreeTrianglesMeetAndOfNothingAreNone) {
  EXPECT_TRUE(ChartsOf({}).empty());
  TriangleMesh leaves;  // three triangles at one edge, one of them without area
  leaves.positions = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 0.5f, 0}};
  leaves.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 1, 4}};
  SetNormals(&leaves);
  size_t triangles = 0;
  for (const Chart& chart : ChartsOf(leaves)) triangles += chart.corners.size();
  EXPECT_EQ(triangles, 3u);
}

}  // namespace
}  // namespace oraclegs
