#include "oraclegs/mesh/simplify.h"

#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

/// A square of side 1 in z = 0 as a grid of n * n quadrilaterals, each with its own lift at the corners.
TriangleMesh GridOf(uint32_t n, float lift) {
  TriangleMesh mesh;
  for (uint32_t y = 0; y <= n; ++y) {
    for (uint32_t x = 0; x <= n; ++x) {
      const auto side = static_cast<float>(n);
      const float z = lift * std::sin(9 * static_cast<float>(x) / side) * std::cos(7 * static_cast<float>(y) / side);
      mesh.positions.emplace_back(static_cast<float>(x) / side, static_cast<float>(y) / side, z);
    }
  }
  for (uint32_t y = 0; y < n; ++y) {
    for (uint32_t x = 0; x < n; ++x) {
      const uint32_t a = y * (n + 1) + x, c = a + n + 1;
      mesh.triangles.push_back({a, a + 1, c});
      mesh.triangles.push_back({a + 1, c + 1, c});
    }
  }
  return mesh;
}

double AreaOf(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f& a = mesh.positions[t[0]];
    area += (mesh.positions[t[1]] - a).cross(mesh.positions[t[2]] - a).norm() / 2;
  }
  return area;
}

TEST(Simplified, KeepsTheSurfaceWithFewerTriangles) {
  const TriangleMesh mesh = GridOf(60, 0.1f);
  const TriangleMesh simple = Simplified(mesh, 1000);
  EXPECT_LE(simple.triangles.size(), 1000u);
  EXPECT_GT(simple.triangles.size(), 900u);
  EXPECT_LT(simple.positions.size(), 700u) << "none that no triangle uses";
  EXPECT_NEAR(AreaOf(simple), AreaOf(mesh), 0.01 * AreaOf(mesh));
  EXPECT_EQ(Simplified(mesh, 1000).triangles, simple.triangles);
}

TEST(Simplified, OfFewOrAllChangesNothing) {
  const TriangleMesh mesh = GridOf(10, 0);
  EXPECT_EQ(Simplified(mesh, 200).triangles, mesh.triangles);
  EXPECT_EQ(Simplified(mesh, 0).triangles, mesh.triangles);
  EXPECT_THROW(Simplified(mesh, 1), ShapeError);
  EXPECT_TRUE(Simplified({}, 100).triangles.empty());
}

TEST(Simplified, ReachesTheNumberWhereNoEdgeCanGo) {
  TriangleMesh crumbs;  // triangles that share no edge have nothing but corners
  for (uint32_t i = 0; i < 900; ++i) {
    const auto x = static_cast<float>(i % 30), y = static_cast<float>(i / 30);
    for (const auto& [dx, dy] : {std::pair(0.f, 0.f), {0.9f, 0.f}, {0.f, 0.9f}}) {
      crumbs.positions.emplace_back(x + dx, y + dy, 0.1f * dx);
    }
    crumbs.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  EXPECT_LE(Simplified(crumbs, 200).triangles.size(), 200u);
}

}  // namespace
}  // namespace oraclegs
