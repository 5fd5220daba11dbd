#pragma once
// Distance of a point from the surfaces of the demo scene: the truth for reconstructions of its images.

#include <vector>

#include "oraclegs/demo/raytracer.h"

namespace oraclegs {

/// The exact distance of a point (world) to the surface of a solid, from either side.
double DistanceToSurface(const Solid& shape, const Vec3& point);

/// The distance to the nearest surface of the objects.
double DistanceToScene(const std::vector<SceneObject>& objects, const Vec3& point);

}  // namespace oraclegs
