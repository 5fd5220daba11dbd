#pragma once
// Views of shapes in closed form, as SurfaceViewOf makes them of renders.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "oraclegs/camera/camera_path.h"
#include "oraclegs/core/files.h"
#include "oraclegs/mesh/surface_view.h"

#define SKIP_WITHOUT_OPENVDB() \
  if (!oraclegs::FindLibraryFile("liboraclegs_openvdb.so")) GTEST_SKIP() << "this build has no OpenVDB"

namespace oraclegs {

/// z along the optical axis of the point that a ray hits, 0 = none. `ray` has unit z in the camera's frame; both
/// arguments are in the world.
using ShapeDepth = std::function<double(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray)>;

inline ShapeDepth SphereAt(const Eigen::Vector3d& center, double radius) {
  return [=](const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
    const Eigen::Vector3d to = center - origin;
    const double a = ray.squaredNorm(), b = ray.dot(to), c = to.squaredNorm() - radius * radius;
    const double root = b * b - a * c;
    return root < 0 ? 0.0 : (b - std::sqrt(root)) / a;
  };
}

inline ShapeDepth FloorAt(double height) {
  return [=](const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
    return ray.z() < 0 ? (height - origin.z()) / ray.z() : 0;
  };
}

inline Camera ShapeCamera(const Eigen::Vector3d& center, const Eigen::Vector3d& target, int side = 96) {
  Camera camera;
  camera.width = camera.height = side;
  camera.fx = camera.fy = side, camera.cx = camera.cy = side / 2.0;
  camera.cam_from_world = LookAt(center, target, Eigen::Vector3d(0.01, 0.02, 1).normalized());
  return camera;
}

/// An opaque render of the shape; its color is (0.25, 0.5, 0.75).
inline SurfaceView ViewOfShape(const ShapeDepth& shape, const Camera& camera) {
  RenderOutput render;
  render.alpha = Buffer<float>::Zeros({camera.height, camera.width});
  render.inv_depth = Buffer<float>::Zeros({camera.height, camera.width});
  render.image = Buffer<float>::Zeros({camera.height, camera.width, 3});
  for (int64_t i = 0; i < render.alpha.count(); ++i) {
    const Eigen::Vector3d ray((static_cast<double>(i % camera.width) + 0.5 - camera.cx) / camera.fx,
                              (static_cast<double>(i / camera.width) + 0.5 - camera.cy) / camera.fy, 1);
    const double z = shape(camera.Center(), camera.cam_from_world.linear().transpose() * ray);
    if (z <= 0) continue;
    render.alpha[i] = 1;
    render.inv_depth[i] = static_cast<float>(1 / z);
    for (int64_t c = 0; c < 3; ++c) render.image[3 * i + c] = 0.25f * static_cast<float>(c + 1);
  }
  return SurfaceViewOf(render, camera);
}

/// Eight cameras from above and eight from below, looking at the origin.
inline std::vector<Camera> ShapeCamerasAround(double distance) {
  std::vector<Camera> cameras;
  for (int i = 0; i < 16; ++i) {
    const double a = 2 * 3.14159265 * i / 8, z = i < 8 ? 0.8 : -0.8;
    cameras.push_back(ShapeCamera(distance * Eigen::Vector3d(std::cos(a), std::sin(a), z).normalized(), {0, 0, 0}));
  }
  return cameras;
}

}  // namespace oraclegs
