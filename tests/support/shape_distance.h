#pragma once
// Distance of a point from the surfaces of the demo scene: the truth for reconstructions of its images.

#include <algorithm>
#include <cmath>
#include <vector>

#include "oraclegs/demo/demo_kinds.h"

namespace oraclegs {

inline double DistanceToBox(const Vec3& p, const Vec3& half) {
  const double x = std::abs(p.x) - half.x, y = std::abs(p.y) - half.y, z = std::abs(p.z) - half.z;
  const Vec3 beyond{std::max(x, 0.0), std::max(y, 0.0), std::max(z, 0.0)};
  return std::abs(Length(beyond) + std::min(std::max({x, y, z}), 0.0));
}

inline double DistanceToCylinder(const Vec3& p, double radius, double half_height) {
  const double r = std::hypot(p.x, p.y) - radius, z = std::abs(p.z) - half_height;
  return std::abs(std::hypot(std::max(r, 0.0), std::max(z, 0.0)) + std::min(std::max(r, z), 0.0));
}

/// The exact distance of a point (world) to the surface of a solid, from either side.
inline double DistanceToSurface(const Solid& shape, const Vec3& point) {
  const Vec3 offset = point - shape.center;
  const Vec3 p{Dot(offset, shape.axis_x), Dot(offset, shape.axis_y), Dot(offset, shape.axis_z)};
  switch (shape.kind) {
    case ShapeKind::kSphere:
      return std::abs(Length(p) - shape.size.x);
    case ShapeKind::kCylinder:
      return DistanceToCylinder(p, shape.size.x, shape.size.z);
    case ShapeKind::kTorus:
      return std::abs(std::hypot(std::hypot(p.x, p.y) - shape.size.x, p.z) - shape.size.y);
    default:
      return DistanceToBox(p, shape.size);
  }
}

/// The distance to the nearest surface of the objects.
inline double DistanceToScene(const std::vector<SceneObject>& objects, const Vec3& point) {
  double nearest = 1e300;
  for (const SceneObject& object : objects) nearest = std::min(nearest, DistanceToSurface(object.shape, point));
  return nearest;
}

}  // namespace oraclegs
