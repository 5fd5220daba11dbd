#pragma once
// Plane hypotheses of stereo, and their maps of pixels from one view to another.

#include <Eigen/Core>

#include "oraclegs/camera/camera.h"
#include "oraclegs/depth/plane_math.h"

namespace oraclegs {

/// Map from pixel coordinates of one view to another's: the point at (u, v) with inverse depth w projects to the
/// homogeneous pixel rotation * (u, v, 1) + translation * w, both in the frame whose pixel (0,0) has its center at
/// (0.5, 0.5). The third coordinate is the depth in the other view divided by the depth in this one.
struct PixelMap {
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
  Eigen::Vector3f translation = Eigen::Vector3f::Zero();

  Eigen::Vector3f operator()(float u, float v, float inv_depth) const {
    return rotation.col(0) * u + rotation.col(1) * v + rotation.col(2) + translation * inv_depth;
  }
};

PixelMap MapBetween(const Camera& from, const Camera& to);
PlainPixelMap Plain(const PixelMap& map);

/// Direction, in the camera's frame and not normalized, of the pixel (u, v), with z = 1.
inline Eigen::Vector3f RayOf(const Camera& camera, float u, float v) {
  return {(u - static_cast<float>(camera.cx)) / static_cast<float>(camera.fx),
          (v - static_cast<float>(camera.cy)) / static_cast<float>(camera.fy), 1.f};
}

/// Unit normal in the camera's frame, toward the camera, of a plane at the pixel (u, v).
Eigen::Vector3f NormalOf(const Camera& camera, const Plane& plane, float u, float v);

}  // namespace oraclegs
