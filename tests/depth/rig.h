#pragma once
// Cameras and images of surfaces whose depth is known in closed form.

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// A camera at `eye` that looks at `target`, y downwards.
inline Camera CameraAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, int width = 160, int height = 120) {
  Camera camera;
  camera.width = width, camera.height = height;
  camera.fx = camera.fy = 1.1 * width;
  camera.cx = 0.5 * width, camera.cy = 0.5 * height;
  const Eigen::Vector3d z = (target - eye).normalized();
  const Eigen::Vector3d x = Eigen::Vector3d(0, 1, 0).cross(z).normalized();
  Eigen::Matrix3d r;
  r << x.transpose(), z.cross(x).transpose(), z.transpose();
  camera.cam_from_world.linear() = r;
  camera.cam_from_world.translation() = -(r * eye);
  return camera;
}

/// A color that varies smoothly and never repeats nearby.
inline Eigen::Vector3f TextureAt(double u, double v) {
  Eigen::Vector3f rgb;
  for (int c = 0; c < 3; ++c) {
    double value = 0;
    for (int k = 1; k <= 5; ++k) {
      value += std::sin(u * (3.1 * k + 0.7 * c) + 1.3 * k * k) * std::sin(v * (2.3 * k * k - 0.9 * c) + 0.4 * k) / k;
    }
    rgb[c] = static_cast<float>(0.5 + 0.3 * value);
  }
  return rgb;
}

/// The plane through `point` with `normal`, textured, as the camera sees it; `background` elsewhere.
struct TexturedPlane {
  Eigen::Vector3d point{0, 0, 0}, normal{0, 0, -1};
  double half_side = 1e9;  ///< half the side of the visible square
  Eigen::Vector3f background{1, 1, 1};

  /// Depth along the optical axis at a pixel's center, 0 beside the square.
  double DepthAt(const Camera& camera, double u, double v, Eigen::Vector2d* uv = nullptr) const {
    const Eigen::Vector3d ray((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1);
    const Eigen::Vector3d direction = camera.cam_from_world.linear().transpose() * ray;
    const double t = (point - camera.Center()).dot(normal) / direction.dot(normal);
    if (!(t > 0)) return 0;
    const Eigen::Vector3d hit = camera.Center() + t * direction - point;
    const Eigen::Vector3d a = normal.unitOrthogonal(), b = normal.cross(a);
    const Eigen::Vector2d at(hit.dot(a), hit.dot(b));
    if (at.cwiseAbs().maxCoeff() > half_side) return 0;
    if (uv != nullptr) *uv = at;
    return t;
  }

  LoadedView Take(const Camera& camera, const std::string& name) const {
    LoadedView view{name, camera, {camera.width, camera.height, 3, {}}, {}};
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        Eigen::Vector2d uv;
        const bool hit = DepthAt(camera, x + 0.5, y + 0.5, &uv) > 0;
        const Eigen::Vector3f rgb = hit ? TextureAt(uv.x(), uv.y()) : background;
        for (int c = 0; c < 3; ++c) view.rgb.data.push_back(rgb[c]);
      }
    }
    return view;
  }
};

}  // namespace oraclegs
