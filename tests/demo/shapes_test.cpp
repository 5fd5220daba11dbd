#include "oraclegs/demo/shapes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace oraclegs {
namespace {

constexpr double kFar = 1e9;

TEST(SinCosOfTurns, AgreesWithLibm) {
  for (double turns = -2.3; turns < 2.3; turns += .0137) {
    const SinCos got = SinCosOfTurns(turns);
    EXPECT_NEAR(got.sin, std::sin(2 * M_PI * turns), 1e-13) << turns;
    EXPECT_NEAR(got.cos, std::cos(2 * M_PI * turns), 1e-13) << turns;
  }
}

TEST(Intersect, SphereFrontAndBack) {
  const Solid sphere = MakeSolid(ShapeKind::kSphere, {.5, 0, 0}, {1, 2, 3});
  const Ray ray{{1, 2, 0}, {0, 0, 1}};
  const auto front = Intersect(sphere, ray, 1e-6, kFar);
  ASSERT_TRUE(front);
  EXPECT_NEAR(front->t, 2.5, 1e-12);
  EXPECT_NEAR(front->normal.z, -1, 1e-12);
  EXPECT_NEAR(front->local.z, -.5, 1e-12);
  EXPECT_NEAR(Intersect(sphere, ray, 2.6, kFar)->t, 3.5, 1e-12);
  EXPECT_FALSE(Intersect(sphere, ray, 1e-6, 2.4));
  EXPECT_FALSE(Intersect(sphere, Ray{{1.6, 2, 0}, {0, 0, 1}}, 1e-6, kFar));
}

TEST(Intersect, TurnedBoxShowsItsCorner) {
  const Solid box = MakeSolid(ShapeKind::kBox, {1, 1, 1}, {0, 5, 0}, .125);  // 45 degrees: a vertical edge in front
  const auto hit = Intersect(box, Ray{{.001, 0, 0}, {0, 1, 0}}, 1e-6, kFar);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 5 - std::sqrt(2.0) + .001, 1e-9);
  EXPECT_NEAR(hit->normal.y, -std::sqrt(.5), 1e-9);
}

TEST(Intersect, CylinderSideAndCap) {
  const Solid cylinder = MakeSolid(ShapeKind::kCylinder, {.5, 0, 1}, {0, 0, 0});
  const auto side = Intersect(cylinder, Ray{{0, -3, .3}, {0, 1, 0}}, 1e-6, kFar);
  ASSERT_TRUE(side);
  EXPECT_NEAR(side->t, 2.5, 1e-12);
  EXPECT_NEAR(side->normal.y, -1, 1e-12);
  const auto cap = Intersect(cylinder, Ray{{.2, .1, 4}, {0, 0, -1}}, 1e-6, kFar);
  ASSERT_TRUE(cap);
  EXPECT_NEAR(cap->t, 3, 1e-12);
  EXPECT_NEAR(cap->normal.z, 1, 1e-12);
  EXPECT_FALSE(Intersect(cylinder, Ray{{0, -3, 1.1}, {0, 1, 0}}, 1e-6, kFar));
}

TEST(Intersect, TorusTubeAndHole) {
  const Solid torus = MakeSolid(ShapeKind::kTorus, {1, .25, 0}, {0, 0, 0});
  const auto tube = Intersect(torus, Ray{{1, 0, 2}, {0, 0, -1}}, 1e-6, kFar);
  ASSERT_TRUE(tube);
  EXPECT_NEAR(tube->t, 1.75, 1e-6);
  EXPECT_NEAR(tube->normal.z, 1, 1e-6);
  EXPECT_FALSE(Intersect(torus, Ray{{0, 0, 2}, {0, 0, -1}}, 1e-6, kFar)) << "through the hole";
  const Ray leaving{{1, 0, .25}, Normalized({.3, 0, 1})};
  EXPECT_FALSE(Intersect(torus, leaving, 1e-5, kFar)) << "a ray that starts on the surface does not hit it";
}

TEST(Intersect, RoomIsSeenFromInside) {
  const Solid room = MakeSolid(ShapeKind::kRoom, {2, 3, 1}, {0, 0, 0});
  const auto hit = Intersect(room, Ray{{.5, 0, 0}, {1, 0, 0}}, 1e-6, kFar);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 1.5, 1e-12);
  EXPECT_NEAR(hit->normal.x, -1, 1e-12);
  EXPECT_NEAR(hit->local_normal.x, 1, 1e-12);
}

TEST(MakeSolid, AxesAreOrthonormal) {
  const Solid shape = MakeSolid(ShapeKind::kBox, {1, 2, 3}, {0, 0, 0}, .13, .37);
  EXPECT_NEAR(Dot(shape.axis_x, shape.axis_y), 0, 1e-13);
  EXPECT_NEAR(Dot(shape.axis_y, shape.axis_z), 0, 1e-13);
  EXPECT_NEAR(Length(Cross(shape.axis_x, shape.axis_y) - shape.axis_z), 0, 1e-13);
}

}  // namespace
}  // namespace oraclegs
