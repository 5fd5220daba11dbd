#pragma once
// Training cameras around or before a scene, and points of its surface.

#include <cmath>
#include <numbers>
#include <vector>

#include "oraclegs/camera/camera_path.h"
#include "oraclegs/depth/fusion.h"

namespace oraclegs {

inline Camera RigCamera(const Eigen::Vector3d& center, const Eigen::Vector3d& target) {
  Camera camera{.width = 64, .height = 48, .fx = 50, .fy = 52, .cx = 31, .cy = 24.5, .cam_from_world = {}};
  camera.cam_from_world = LookAt(center, target, Eigen::Vector3d::UnitZ());
  return camera;
}

/// Cameras that look at the origin from a distance of 4, at elevations that vary between 10 and 60 degrees.
inline std::vector<Camera> RigAround(int n, double degrees = 360) {
  std::vector<Camera> cameras;
  for (int i = 0; i < n; ++i) {
    const double azimuth = degrees * i / n * std::numbers::pi / 180;
    const double elevation = (10 + 50. * (i * 3 % n) / n) * std::numbers::pi / 180;
    cameras.push_back(RigCamera(4 * Eigen::Vector3d(std::cos(azimuth) * std::cos(elevation),
                                                    std::sin(azimuth) * std::cos(elevation), std::sin(elevation)),
                                Eigen::Vector3d::Zero()));
  }
  return cameras;
}

/// Cameras that look along +y, near the x-z plane.
inline std::vector<Camera> RigForward(int n) {
  std::vector<Camera> cameras;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d center(0.3 * i, 0.02 * (i % 2), 0.1 * (i * 2 % 3));
    cameras.push_back(RigCamera(center, center + Eigen::Vector3d(0.02 * (i % 3), 5, 0)));
  }
  return cameras;
}

/// Points evenly on a sphere, normals outward.
inline std::vector<DensePoint> SpherePoints(int n, double radius) {
  std::vector<DensePoint> points;
  for (int i = 0; i < n; ++i) {
    const double z = 1 - 2 * (i + 0.5) / n, angle = i * 2.399963229728653, r = std::sqrt(1 - z * z);
    const Eigen::Vector3f normal = Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z).cast<float>();
    points.push_back({static_cast<float>(radius) * normal, normal, {0.5f, 0.5f, 0.5f}});
  }
  return points;
}

}  // namespace oraclegs
