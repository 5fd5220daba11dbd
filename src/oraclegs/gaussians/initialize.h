#pragma once
// Where the Gaussians start (spec/gaussian_core.md 8).

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/scene/camera.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Coloured points to start from.
struct PointCloud {
  std::vector<Eigen::Vector3f> xyz;
  std::vector<Eigen::Vector3f> rgb;  ///< [0, 1]
};

PointCloud ToPointCloud(const std::vector<ScenePoint>& points);

/// Radius of the training cameras: 1.1 * max distance of a camera centre from their mean (getNerfppNorm).
double SpatialExtent(const std::vector<Camera>& cameras);

/// n points uniform in the Blender cube [-1.3, 1.3]^3, colours near grey.
PointCloud RandomPointsInBlenderCube(int64_t n, uint64_t seed);

/// n points uniform in the part of space that at least two training cameras look at (one when no two overlap), between
/// near and far bounds taken from the cameras' distance to the point nearest to all optical axes; colours near grey.
PointCloud RandomPointsInView(const std::vector<Camera>& cameras, int64_t n, uint64_t seed);

/// Mean squared distance of each point to its three nearest other points, at least 1e-7; exact, on all threads.
std::vector<float> MeanSquaredNeighborDistance(const std::vector<Eigen::Vector3f>& points);

struct InitializeOptions {
  double scale_factor = 0.1;  ///< of the root mean squared neighbour distance ([MCMC]'s 0.1; [3DGS] has 1)
  double opacity = 0.5;       ///< start opacity
};

/// Gaussians at the points: sh0 from the colour, identity rotation, isotropic scale from the neighbours.
Gaussians InitializeGaussians(const PointCloud& points, const InitializeOptions& options);

}  // namespace oraclegs
