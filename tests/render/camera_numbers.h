#pragma once
// The ten numbers of a camera that the rasterizer differentiates, and scenes before a camera in general position.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "oraclegs/camera/similarity.h"
#include "render/scenes.h"

namespace oraclegs {

/// Translation, rotation, fx, fy, cx, cy, as in CameraGradient.
using CameraNumbers = std::array<double, 10>;

inline CameraNumbers NumbersOf(const CameraGradient& g) {
  return {g.translation.x(),
          g.translation.y(),
          g.translation.z(),
          g.rotation.x(),
          g.rotation.y(),
          g.rotation.z(),
          g.fx,
          g.fy,
          g.cx,
          g.cy};
}

inline Camera Changed(const Camera& camera, const CameraNumbers& by) {
  Camera out = camera;
  out.cam_from_world = Nudged(camera.cam_from_world, {by[3], by[4], by[5]}, {by[0], by[1], by[2]});
  out.fx += by[6], out.fy += by[7], out.cx += by[8], out.cy += by[9];
  return out;
}

inline Camera PosedCamera(int width, int height) {
  Camera camera = FrontCamera(width, height);
  camera.cam_from_world = Nudged(camera.cam_from_world, {0.5, -0.8, 0.3}, {0.7, -0.4, 1.1});
  return camera;
}

/// RandomGaussians as FrontCamera sees them, before PosedCamera.
struct PosedScene {
  Gaussians gaussians;
  Camera camera;

  PosedScene(Gaussians gaussians, Camera camera) : gaussians(std::move(gaussians)), camera(std::move(camera)) {}
  PosedScene(int64_t n, double scale, std::array<int, 2> size)
      : gaussians(RandomGaussians(n, scale, 21)), camera(PosedCamera(size[0], size[1])) {
    const Eigen::Isometry3f world_from_cam = camera.cam_from_world.inverse().cast<float>();
    for (int64_t i = 0; i < n; ++i) {
      Eigen::Map<Eigen::Vector3f> mean(gaussians.means.data() + 3 * i);
      mean = world_from_cam * mean;
    }
  }
};

/// Compares each number with the central difference of loss(camera), within 2e-3 of the largest of its group: shifts,
/// turns, focal lengths, principal point. The best of three steps is taken, since a pixel that crosses a threshold
/// between the two sides is a jump, not a derivative.
template <class Loss>
void ExpectCameraDifferences(const Camera& camera, const Loss& loss, const CameraNumbers& gradient) {
  constexpr size_t kGroups[] = {0, 3, 6, 8, 10};
  for (int group = 0; group < 4; ++group) {
    double scale = 0;
    for (size_t k = kGroups[group]; k < kGroups[group + 1]; ++k) scale = std::max(scale, std::abs(gradient[k]));
    for (size_t k = kGroups[group]; k < kGroups[group + 1]; ++k) {
      double best = 1e30;
      for (const double step : {1e-4, 1e-5, 1e-6}) {
        CameraNumbers change{};
        change[k] = step;
        const double above = loss(Changed(camera, change));
        change[k] = -step;
        const double derivative = (above - loss(Changed(camera, change))) / (2 * step);
        best = std::min(best, std::abs(derivative - gradient[k]));
      }
      EXPECT_LE(best, 2e-3 * scale) << "number " << k << ": " << gradient[k];
    }
  }
}

}  // namespace oraclegs
