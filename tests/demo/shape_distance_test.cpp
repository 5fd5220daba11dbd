#include "support/shape_distance.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(DistanceToSurface, IsMeasuredFromBothSides) {
  EXPECT_NEAR(DistanceToSurface(MakeSolid(ShapeKind::kSphere, {2, 0, 0}, {1, 0, 0}), {1, 0, 5}), 3, 1e-12);
  EXPECT_NEAR(DistanceToSurface(MakeSolid(ShapeKind::kSphere, {2, 0, 0}, {1, 0, 0}), {1, 0.5, 0}), 1.5, 1e-12);
  const Solid box = MakeSolid(ShapeKind::kBox, {1, 2, 3}, {0, 0, 0});
  EXPECT_NEAR(DistanceToSurface(box, {4, 6, 0}), 5, 1e-12);
  EXPECT_NEAR(DistanceToSurface(box, {0.9, 0, 0}), 0.1, 1e-12);
  EXPECT_NEAR(DistanceToSurface(MakeSolid(ShapeKind::kRoom, {1, 2, 3}, {0, 0, 0}), {0, 0, 2.5}), 0.5, 1e-12);
  const Solid cylinder = MakeSolid(ShapeKind::kCylinder, {1, 0, 2}, {0, 0, 0});
  EXPECT_NEAR(DistanceToSurface(cylinder, {4, 0, 6}), 5, 1e-12);
  EXPECT_NEAR(DistanceToSurface(cylinder, {0, 0, 1.75}), 0.25, 1e-12);
  const Solid torus = MakeSolid(ShapeKind::kTorus, {3, 1, 0}, {0, 0, 0});
  EXPECT_NEAR(DistanceToSurface(torus, {0, 0, 0}), 2, 1e-12);
  EXPECT_NEAR(DistanceToSurface(torus, {3, 0, 0.25}), 0.75, 1e-12);
}

TEST(DistanceToSurface, AgreesWithRays) {
  for (const SceneObject& object : DemoWorld(DemoKind::kRoom).objects) {
    const Vec3 from = object.shape.kind == ShapeKind::kRoom ? Vec3{0.1, 0.2, 1} : Vec3{0.3, -3, 1.7};
    int hits = 0;
    for (int i = 0; i < 400; ++i) {
      const Vec3 to = object.shape.center + Vec3{0.02 * (i % 20) - 0.2, 0.03, 0.02 * (i / 20) - 0.2};
      const Ray ray{from, Normalized(to - from)};
      const auto hit = Intersect(object.shape, ray, 1e-6, 100);
      if (!hit) continue;
      ++hits;
      EXPECT_NEAR(DistanceToSurface(object.shape, ray.origin + hit->t * ray.direction), 0, 1e-7);
    }
    EXPECT_GT(hits, 0);
  }
}

TEST(DistanceToScene, IsThatOfTheNearestObject) {
  const std::vector<SceneObject> objects = {{MakeSolid(ShapeKind::kSphere, {1, 0, 0}, {0, 0, 0})},
                                            {MakeSolid(ShapeKind::kSphere, {1, 0, 0}, {5, 0, 0})}};
  EXPECT_NEAR(DistanceToScene(objects, {3.5, 0, 0}), 0.5, 1e-12);
}

}  // namespace
}  // namespace oraclegs
