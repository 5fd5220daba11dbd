#pragma once
// Where the Gaussians start (docs/method.md#initialization).

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Colored points to start from.
struct PointCloud {
  std::vector<Eigen::Vector3f> xyz;
  std::vector<Eigen::Vector3f> rgb;  ///< [0, 1]
};

PointCloud ToPointCloud(const std::vector<ScenePoint>& points);

/// Reads a PLY of colored points: x y z, and red green blue of 8 bits or of numbers up to 1; gray without. Points
/// that are not finite are left out. Throws InputError naming the file.
PointCloud ReadPointPly(const std::filesystem::path& path);

/// n points uniform in the Blender cube [-1.3, 1.3]^3, colors near gray.
PointCloud RandomPointsInBlenderCube(int64_t n, uint64_t seed);

/// n points uniform in the part of space that at least two training cameras look at (one when no two overlap), between
/// near and far bounds taken from the cameras' distance to the point nearest to all optical axes; colors near gray.
PointCloud RandomPointsInView(const std::vector<Camera>& cameras, int64_t n, uint64_t seed);

/// n points uniform in the cube [-3r, 3r]^3 around the world's origin, r = SpatialExtent(cameras), colors near gray:
/// the random start of [Kheradmand 2024] for scenes that are not Blender's.
PointCloud RandomPointsInCube(const std::vector<Camera>& cameras, int64_t n, uint64_t seed);

/// Mean squared distance of each point to its three nearest other points, at least 1e-7; exact. On all threads, or on
/// the GPU that `device` names, which becomes the current one. Throws UsageError for a device this build cannot use.
std::vector<float> MeanSquaredNeighborDistance(const std::vector<Eigen::Vector3f>& points, Device device = kCpu);

struct InitializeOptions {
  double scale_factor = 0.1;  ///< factor of the RMS neighbor distance ([Kheradmand 2024]: 0.1; [Kerbl 2023]: 1)
  double opacity = 0.5;       ///< start opacity
};

/// Gaussians at the points: sh0 from the color, scale from the neighbors; isotropic and not rotated. The buffers
/// are the host's; `device` is where the neighbors are looked for.
Gaussians InitializeGaussians(const PointCloud& points, const InitializeOptions& options, Device device = kCpu);

}  // namespace oraclegs
