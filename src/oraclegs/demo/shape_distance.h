#pragma once
// How far a point is from the surfaces of the demo scene: truth for what is reconstructed from its images.

#include <vector>

#include "oraclegs/demo/raytracer.h"

namespace oraclegs {

/// The exact distance of a point (world) to the surface of a solid, from either side.
double DistanceToSurface(const Solid& shape, const Vec3& point);

/// The distance to the nearest surface of any of them.
double DistanceToScene(const std::vector<SceneObject>& objects, const Vec3& point);

}  // namespace oraclegs
