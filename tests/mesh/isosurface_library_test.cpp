// The library behind mesh/isosurface.h as a program loads it.

#include "oraclegs/mesh/isosurface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "mesh/views_of_shapes.h"

namespace oraclegs {
namespace {

TriangleMesh FuseShape(const ShapeDepth& shape, const std::vector<Camera>& cameras, double voxel, double adaptivity) {
  TsdfBlocks blocks(voxel, 4 * voxel);
  for (const Camera& camera : cameras) blocks.Add(ViewOfShape(shape, camera));
  TsdfVolume volume(blocks);
  for (const Camera& camera : cameras) volume.Integrate(ViewOfShape(shape, camera));
  TriangleMesh mesh = Isosurface({voxel, &volume.blocks(), &volume.distances(), &volume.weights(), adaptivity, 2});
  SetNormals(&mesh);
  return mesh;
}

TEST(IsosurfaceLibrary, OfASphereHasItsRadiusAndNormals) {
  SKIP_WITHOUT_OPENVDB();
  constexpr double kVoxel = 0.04;
  for (const double adaptivity : {0.0, 0.3}) {
    const TriangleMesh mesh = FuseShape(SphereAt({0, 0, 0}, 1), ShapeCamerasAround(3), kVoxel, adaptivity);
    ASSERT_GT(mesh.triangles.size(), 500u);
    int inward = 0;
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
      EXPECT_NEAR(mesh.positions[i].norm(), 1, kVoxel);
      inward += mesh.normals[i].dot(mesh.positions[i]) < 0.7f ? 1 : 0;
    }
    EXPECT_LT(inward, static_cast<int>(mesh.positions.size() / 100));
    double volume = 0;
    for (const auto& t : mesh.triangles) {
      volume += mesh.positions[t[0]].dot(mesh.positions[t[1]].cross(mesh.positions[t[2]])) / 6;
    }
    EXPECT_NEAR(volume, 4 * 3.14159265 / 3, 0.15) << "closed, and counter-clockwise from outside";
  }
}

TEST(IsosurfaceLibrary, HasNoShellBehindAFloorThatIsSeenFromAbove) {
  SKIP_WITHOUT_OPENVDB();
  constexpr double kVoxel = 0.05;
  const std::vector<Camera> cameras = {ShapeCamera({0, 0, 2}, {0, 0, 0}), ShapeCamera({0.5, 0, 2}, {0, 0, 0})};
  const TriangleMesh mesh = FuseShape(FloorAt(0.03), cameras, kVoxel, 0);
  ASSERT_GT(mesh.positions.size(), 200u);
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_NEAR(mesh.positions[i].z(), 0.03, kVoxel / 2);
    EXPECT_GT(mesh.normals[i].z(), 0.8f);
  }
  EXPECT_LT(FuseShape(FloorAt(0.03), cameras, kVoxel, 0.5).triangles.size(), mesh.triangles.size() / 2);
}

}  // namespace
}  // namespace oraclegs
