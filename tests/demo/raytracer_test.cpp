#include "oraclegs/demo/raytracer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

namespace oraclegs {
namespace {

RayCamera LookFrom(const Vec3& center, int width = 80, int height = 60) {
  RayCamera camera;
  camera.width = width;
  camera.height = height;
  camera.focal = .92 * width;
  camera.center = center;
  camera.forward = Normalized(Vec3{0, 0, .6} - center);
  camera.right = Normalized(Cross(camera.forward, {0, 0, 1}));
  camera.down = Cross(camera.forward, camera.right);
  return camera;
}

Vec3 Unproject(const RayCamera& camera, double px, double py, double z) {
  const double x = (px - .5 * camera.width) / camera.focal, y = (py - .5 * camera.height) / camera.focal;
  return camera.center + z * (x * camera.right + y * camera.down + camera.forward);
}

Vec3 ToCamera(const RayCamera& camera, const Vec3& p) {
  const Vec3 d = p - camera.center;
  return {Dot(d, camera.right), Dot(d, camera.down), Dot(d, camera.forward)};
}

TEST(TraceView, DepthsOfTwoViewsAgree) {
  const auto objects = DemoObjects();
  const RayCamera a = LookFrom({-.15, -2.9, 1.2}), b = LookFrom({.15, -2.85, 1.3});
  const RayTracedView from_a = TraceView(objects, a, 1, 0), from_b = TraceView(objects, b, 1, 1);
  int inside = 0, agree = 0, in_front = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const double z = from_a.depth[y * a.width + x] / 1000.0;
      ASSERT_GT(z, 0) << "the room is closed";
      const Vec3 p = ToCamera(b, Unproject(a, x + .5, y + .5, z));
      const auto u = static_cast<int>(std::floor(p.x / p.z * b.focal + .5 * b.width));
      const auto v = static_cast<int>(std::floor(p.y / p.z * b.focal + .5 * b.height));
      if (u < 0 || v < 0 || u >= b.width || v >= b.height) continue;
      ++inside;
      const double seen = from_b.depth[v * b.width + u] / 1000.0;
      agree += std::abs(seen - p.z) < .12;  // slanted surfaces: half a pixel of parallax
      in_front += seen > p.z + .12;
    }
  }
  EXPECT_GT(inside, 3000);
  EXPECT_GT(agree, .9 * inside);
  // b may see something nearer (an occlusion), but hardly ever past a surface that a saw: only at silhouettes.
  EXPECT_LT(in_front, .05 * inside);
}

TEST(TraceView, DepthOfAWallIsExact) {
  // Straight at a wall of a bare room: z depth is the distance of the plane at every pixel.
  const std::vector<SceneObject> room{{MakeSolid(ShapeKind::kRoom, {3, 2, 2}, {0, 0, 0}), Texture::kRoom, 0}};
  RayCamera camera;
  camera.width = 16;
  camera.height = 12;
  camera.focal = 40;
  camera.center = {.1, -1, .2};
  camera.right = {1, 0, 0};
  camera.down = {0, 0, -1};
  camera.forward = {0, 1, 0};
  for (const uint16_t depth : TraceView(room, camera, 1, 0).depth) ASSERT_EQ(depth, 3000);
}

TEST(TraceView, ImagesAreRichAndUnclipped) {
  const RayTracedView view = TraceView(DemoObjects(), LookFrom({-.3, -2.9, 1.2}), 2, 0);
  double sum = 0, edges = 0;
  int clipped = 0;
  const auto& rgb = view.rgb.data;
  for (size_t i = 3; i < rgb.size(); ++i) {
    sum += rgb[i];
    edges += std::abs(rgb[i] - rgb[i - 3]);
    clipped += rgb[i] == 0 || rgb[i] == 255;
  }
  const auto n = static_cast<double>(rgb.size());
  EXPECT_GT(sum / n, 70);
  EXPECT_LT(sum / n, 180);
  EXPECT_GT(edges / n, 8) << "texture for feature matching";
  EXPECT_LT(clipped, .02 * n);
}

TEST(DemoObjects, OnlyTheBallReflects) {
  int mirrors = 0;
  for (const SceneObject& object : DemoObjects()) mirrors += object.mirror > 0;
  EXPECT_EQ(mirrors, 1);
}

}  // namespace
}  // namespace oraclegs
