#include "oraclegs/demo/raytracer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>

#include "oraclegs/demo/demo_kinds.h"

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
  const RayScene scene = DemoWorld(DemoKind::kRoom);
  const RayCamera a = LookFrom({-.15, -2.9, 1.2}), b = LookFrom({.15, -2.85, 1.3});
  const RayTracedView from_a = TraceView(scene, a, 1, 0), from_b = TraceView(scene, b, 1, 1);
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
  const RayScene room{{{MakeSolid(ShapeKind::kRoom, {3, 2, 2}, {0, 0, 0}), Texture::kRoom, 0}}};
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
  const RayTracedView view = TraceView(DemoWorld(DemoKind::kRoom), LookFrom({-.3, -2.9, 1.2}), 2, 0);
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

TEST(TraceView, SurroundingsHaveNoDepth) {
  RayCamera camera = LookFrom({0, -3, .6}, 16, 12);
  RayScene scene{{{MakeSolid(ShapeKind::kSphere, {.3, 0, 0}, {0, 0, .6}), Texture::kCandy}}};
  const auto corner = [&](Surroundings around) {
    scene.around = around;
    const RayTracedView view = TraceView(scene, camera, 2, 0);
    EXPECT_EQ(view.depth.front(), 0);
    EXPECT_NEAR(view.depth[6 * 16 + 8], 2700, 50);
    return std::array<int, 3>{view.rgb.data[0], view.rgb.data[1], view.rgb.data[2]};
  };
  EXPECT_EQ(corner(Surroundings::kRoom), (std::array{0, 0, 0}));
  EXPECT_EQ(corner(Surroundings::kWhite), (std::array{255, 255, 255}));
  const auto sky = corner(Surroundings::kSky);
  EXPECT_GT(sky[2], sky[0] + 30) << "blue";
}

TEST(TraceView, SunThrowsShadowsAlongOneDirection) {
  // Two balls on the ground, ten units apart, have their shadows at the same side and place.
  RayScene scene{{{MakeSolid(ShapeKind::kBox, {30, 30, .5}, {0, 0, -.5}), Texture::kPaint}}, Surroundings::kSky};
  for (const double x : {0., 10.}) scene.objects.push_back({MakeSolid(ShapeKind::kSphere, {.5, 0, 0}, {x, 0, 2})});
  RayCamera camera = LookFrom({0, 0, 8}, 3, 3);
  camera.right = {1, 0, 0}, camera.down = {0, -1, 0}, camera.forward = {0, 0, -1};
  camera.focal = 60;  // the image is .4 units wide on the ground
  const auto brightness = [&](const Vec3& place) {
    camera.center = {place.x, place.y, 1};
    return static_cast<int>(TraceView(scene, camera, 2, 0).rgb.data[12]);
  };
  const Vec3 shadow{1.27, 1.88, 0};  // two units up, the sun leans by .42 and .62 of .66
  EXPECT_LT(brightness(shadow), .75 * brightness(Vec3{-1.27, -1.88, 0}));
  EXPECT_NEAR(brightness(shadow), brightness(shadow + Vec3{10, 0, 0}), 3);
}

}  // namespace
}  // namespace oraclegs
