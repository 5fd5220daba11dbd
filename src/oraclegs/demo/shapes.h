#pragma once
// The solids of the scene. Every one is intersected in its own frame, centerd on the origin with its axis along z.

#include <optional>

#include "oraclegs/demo/vec3.h"

namespace oraclegs {

struct Ray {
  Vec3 origin;
  Vec3 direction;  ///< unit length
};

enum class ShapeKind {
  kSphere,    ///< size.x = radius
  kBox,       ///< size = half extents
  kCylinder,  ///< size.x = radius, size.z = half height, closed by caps
  kTorus,     ///< size.x = radius of the ring, size.y = radius of the tube
  kRoom,      ///< size = half extents; seen from inside
};

struct Solid {
  ShapeKind kind = ShapeKind::kSphere;
  Vec3 size;
  Vec3 center;                                             ///< world
  Vec3 axis_x{1, 0, 0}, axis_y{0, 1, 0}, axis_z{0, 0, 1};  ///< orthonormal, world
  double bound = 0;                                        ///< radius of a sphere around `center` that holds the shape
};

/// A solid rotated by `yaw` turns about the world's z axis and then tilted by `tilt` turns about its own x axis.
Solid MakeSolid(ShapeKind kind, const Vec3& size, const Vec3& center, double yaw = 0, double tilt = 0);

struct ShapeHit {
  double t = 0;       ///< distance along the ray
  Vec3 normal;        ///< world, unit length, against the ray
  Vec3 local;         ///< the point in the shape's frame, in which textures are defined
  Vec3 local_normal;  ///< the outward normal in that frame
};

/// The nearest hit with t in (t_min, t_max).
std::optional<ShapeHit> Intersect(const Solid& shape, const Ray& ray, double t_min, double t_max);

/// True when the ray certainly misses the shape: the cheap test that comes first.
inline bool MissesBound(const Solid& shape, const Ray& ray) {
  const Vec3 to_center = shape.center - ray.origin;
  const double along = Dot(to_center, ray.direction);
  const double distance2 = Dot(to_center, to_center);
  const double bound2 = shape.bound * shape.bound;
  return distance2 > bound2 && (along < 0 || distance2 - along * along > bound2);
}

}  // namespace oraclegs
