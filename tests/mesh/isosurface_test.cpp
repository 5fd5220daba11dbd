#include "oraclegs/mesh/isosurface.h"

#include <gtest/gtest.h>

#include "mesh/views_of_shapes.h"

namespace oraclegs {
namespace {

TEST(Isosurface, OfNothingIsEmpty) {
  SKIP_WITHOUT_OPENVDB();
  EXPECT_NO_THROW(RequireIsosurface());
  const std::vector<std::array<int32_t, 3>> blocks;
  const std::vector<float> none;
  EXPECT_TRUE(Isosurface({1, &blocks, &none, &none, 0, 1}).triangles.empty());
}

TEST(Isosurface, OfOneUncertainBlockIsEmpty) {
  SKIP_WITHOUT_OPENVDB();
  const std::vector<std::array<int32_t, 3>> blocks = {{0, 0, 0}};
  std::vector<float> distances(kBlockVoxels), weights(kBlockVoxels, 0.f);
  for (size_t i = 0; i < distances.size(); ++i) distances[i] = i % 8 < 4 ? -1.f : 1.f;
  EXPECT_TRUE(Isosurface({1, &blocks, &distances, &weights, 0, 1}).triangles.empty());
  weights.assign(kBlockVoxels, 1.f);
  const TriangleMesh mesh = Isosurface({1, &blocks, &distances, &weights, 0, 1});
  EXPECT_FALSE(mesh.triangles.empty());
  for (const Eigen::Vector3f& position : mesh.positions) EXPECT_NEAR(position.z(), 3.5f, 0.51f);
}

}  // namespace
}  // namespace oraclegs
