#include "oraclegs/mesh/triangle_mesh.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

/// A large square in z = 0, a small triangle apart from it, and a vertex of no triangle.
TriangleMesh SquareAndSpeck() {
  TriangleMesh mesh;
  mesh.positions = {{9, 9, 9}, {0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {5, 0, 0}, {5.1f, 0, 0}, {5, 0.1f, 0}};
  mesh.triangles = {{1, 2, 3}, {5, 6, 7}, {1, 3, 4}};
  for (uint8_t i = 0; i < 8; ++i) mesh.colors.push_back({i, 0, 0});
  return mesh;
}

TEST(TriangleMesh, NormalsPointWhereTheTrianglesDo) {
  TriangleMesh mesh = SquareAndSpeck();
  SetNormals(&mesh);
  for (const Eigen::Vector3f& normal : mesh.normals) EXPECT_TRUE(normal.isApprox(Eigen::Vector3f(0, 0, 1)));
}

TEST(TriangleMesh, SmallPartsAreLeftOut) {
  const TriangleMesh kept = WithoutSmallParts(SquareAndSpeck(), 0.01);
  ASSERT_EQ(kept.triangles.size(), 2u);
  ASSERT_EQ(kept.positions.size(), 4u);
  EXPECT_EQ(kept.positions[kept.triangles[1][2]], Eigen::Vector3f(0, 2, 0));
  EXPECT_EQ(kept.colors[kept.triangles[1][2]][0], 4);
  EXPECT_EQ(WithoutSmallParts(SquareAndSpeck(), 0).triangles.size(), 3u);
  EXPECT_TRUE(WithoutSmallParts({}, 0.5).positions.empty());
}

}  // namespace
}  // namespace oraclegs
