#include "oraclegs/mesh/texture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mesh/views_of_shapes.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

/// A square of side 1 on the floor, and a wall beside it that no camera above sees.
TriangleMesh FloorAndWall() {
  TriangleMesh mesh;
  mesh.positions = {{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0},  {0.5f, 0.5f, 0},
                    {-0.5f, 0.5f, 0},  {0.5f, -0.5f, -1}, {0.5f, 0.5f, -1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  SetNormals(&mesh);
  return mesh;
}

TriangleMesh TexturedFloor(int max_side) {
  const Camera above = ShapeCamera({0, 0, 2}, {0, 0, 0});
  const TextureAtlas atlas(FloorAndWall(), {above}, max_side);
  VertexColors colors(atlas.points(), 0.05);
  SurfaceView view = ViewOfShape(FloorAt(0), above);
  for (int64_t i = 0; i < view.image.count(); i += 3) {  // red grows from left to right
    view.image[i] = static_cast<float>(i / 3 % above.width) / static_cast<float>(above.width);
  }
  colors.Add(view);
  return atlas.Textured(colors);
}

TEST(TextureAtlas, HasAPixelOfTheNearestCameraInATexel) {
  const TextureAtlas atlas(FloorAndWall(), {ShapeCamera({0, 0, 2}, {0, 0, 0}), ShapeCamera({0, 0, 9}, {0, 0, 0})},
                           4096);
  EXPECT_EQ(atlas.side(), 128) << "48 texels of floor, some 37 of wall, and gutters";
  EXPECT_NEAR(static_cast<double>(atlas.points().positions.size()), 48 * 48 + 37 * 37, 300);
  for (const Eigen::Vector3f& point : atlas.points().positions) {
    EXPECT_TRUE(std::abs(point.z()) < 1e-4f || std::abs(point.x() - 0.5f) < 1e-4f) << point.transpose();
  }
}

TEST(TextureAtlas, ShowsWhatTheViewsDo) {
  const TriangleMesh mesh = TexturedFloor(4096);
  ASSERT_EQ(mesh.texcoords.size(), mesh.positions.size());
  EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_EQ(mesh.positions.size(), 8u) << "the edge between floor and wall twice";
  const Camera above = ShapeCamera({0, 0, 2}, {0, 0, 0});
  const auto side = static_cast<float>(mesh.texture.width);
  for (const auto& t : {mesh.triangles[0], mesh.triangles[1]}) {
    for (const auto& [a, b] : {std::pair(0.2f, 0.3f), {0.5f, 0.25f}, {0.1f, 0.8f}}) {
      const float c = 1 - a - b;
      const Eigen::Vector2f at =
          side * (a * mesh.texcoords[t[0]] + b * mesh.texcoords[t[1]] + c * mesh.texcoords[t[2]]);
      const Eigen::Vector3f point = a * mesh.positions[t[0]] + b * mesh.positions[t[1]] + c * mesh.positions[t[2]];
      const Eigen::Vector3d seen = above.cam_from_world * point.cast<double>();
      const double red = (above.fx * seen.x() / seen.z() + above.cx - 0.5) / above.width;
      const size_t texel =
          static_cast<size_t>(at.y()) * static_cast<size_t>(mesh.texture.width) + static_cast<size_t>(at.x());
      EXPECT_NEAR(mesh.texture.data[3 * texel], 255 * red, 4);
      EXPECT_EQ(mesh.texture.data[3 * texel + 1], 128);
      EXPECT_EQ(mesh.texture.data[3 * texel + 2], 191);
    }
  }
}

TEST(TextureAtlas, IsTheSameOnAnyNumberOfThreads) {
  SetNumThreads(1);
  const TriangleMesh one = TexturedFloor(512);
  SetNumThreads(3);
  const TriangleMesh three = TexturedFloor(512);
  SetNumThreads(0);
  EXPECT_EQ(one.texture.data, three.texture.data);
  EXPECT_EQ(one.texcoords, three.texcoords);
}

TEST(TextureAtlas, ShrinksToTheSideOrNamesIt) {
  const TriangleMesh small = TexturedFloor(64);
  EXPECT_EQ(small.texture.width, 64);
  for (const Eigen::Vector2f& at : small.texcoords) {
    EXPECT_GE(at.minCoeff(), 0);
    EXPECT_LE(at.maxCoeff(), 1);
  }
  EXPECT_THAT(MessageOf<UsageError>([] { TexturedFloor(4); }), testing::HasSubstr("--texture is 4: too small"));
}

}  // namespace
}  // namespace oraclegs
