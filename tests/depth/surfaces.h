#pragma once
// What stereo should find of a textured plane, in the forms its parts exchange.

#include <algorithm>
#include <vector>

#include "depth/rig.h"
#include "oraclegs/core/error.h"
#include "oraclegs/depth/depth_map.h"
#include "oraclegs/depth/patch_match.h"

namespace oraclegs {

/// Surfaces for tests with cameras of Arc.
inline const TexturedPlane kSlanted{{0, 0, 0.3}, Eigen::Vector3d(0.4, -0.3, -1).normalized()};
inline const TexturedPlane kSteep{{0, 0, 0.3}, Eigen::Vector3d(0.5, -0.3, -1).normalized()};
inline constexpr DepthRange kSteepRange{1 / 9.f, 1 / 1.5f};

/// Small cameras on an arc of radius 4 around the origin, `step` degrees apart, a little up and down by turns.
inline std::vector<Camera> Arc(int n, double step, int width = 96, int height = 72) {
  std::vector<Camera> cameras;
  for (int i = 0; i < n; ++i) {
    const double angle = (i - (n - 1) / 2.0) * step * M_PI / 180;
    const Eigen::Vector3d eye(4 * std::sin(angle), i % 2 == 0 ? 0.25 : -0.25, -4 * std::cos(angle));
    cameras.push_back(CameraAt(eye, {0, 0, 0}, width, height));
  }
  return cameras;
}

inline std::vector<LoadedView> TakeAll(const TexturedPlane& surface, const std::vector<Camera>& cameras) {
  std::vector<LoadedView> views;
  for (size_t v = 0; v < cameras.size(); ++v) views.push_back(surface.Take(cameras[v], fmt::format("p{}.png", v)));
  return views;
}

/// The surface at every pixel of a camera, nothing where the camera does not see it.
inline PlaneMap TrueMap(const Camera& camera, const TexturedPlane& surface, float cost = 0.1f) {
  PlaneMap map{camera.width, camera.height, {}, {}};
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double u = x + 0.5, v = y + 0.5;
      TexturedPlane endless = surface;
      endless.half_side = 1e9;
      const double w = 1 / endless.DepthAt(camera, u, v);
      const bool hit = surface.DepthAt(camera, u, v) > 0;
      map.planes.push_back(hit ? Plane{static_cast<float>(w),
                                       static_cast<float>(1 / endless.DepthAt(camera, u + 1, v) - w),
                                       static_cast<float>(1 / endless.DepthAt(camera, u, v + 1) - w)}
                               : Plane{});
      map.costs.push_back(hit ? cost : kWorstCost);
    }
  }
  return map;
}

inline DepthMap TrueDepth(const LoadedView& view, const TexturedPlane& surface, float confidence) {
  const PlaneMap planes = TrueMap(view.camera, surface);
  DepthMap map{view.name, view.camera, {}, {}, {}};
  const Eigen::Vector3f normal = (view.camera.cam_from_world.linear() * surface.normal).cast<float>();
  for (const Plane& plane : planes.planes) {
    const bool known = plane.inv_depth > 0;
    map.inv_depth.push_back(plane.inv_depth);
    map.normals.push_back(known ? normal : Eigen::Vector3f::Zero());
    map.confidence.push_back(known ? confidence : 0);
  }
  return map;
}

/// Views that are all compared with one another, in gray.
inline StereoScene SceneOf(const std::vector<LoadedView>& views, const DepthRange& range) {
  StereoScene scene;
  for (size_t v = 0; v < views.size(); ++v) {
    StereoView view{views[v].camera, Pack(Luma(views[v].rgb)), {}, range, {}};
    for (size_t other = 0; other < views.size(); ++other) {
      if (other != v) view.neighbors.push_back(static_cast<int>(other));
    }
    scene.views.push_back(std::move(view));
  }
  return scene;
}

/// Fraction of the pixels whose inverse depth is within `tolerance` (relative) of the surface's.
inline double ShareRight(const PlaneMap& map, const PlaneMap& truth, float tolerance) {
  size_t right = 0;
  for (size_t i = 0; i < map.planes.size(); ++i) {
    right += std::abs(map.planes[i].inv_depth / truth.planes[i].inv_depth - 1) < tolerance ? 1 : 0;
  }
  return static_cast<double>(right) / static_cast<double>(map.planes.size());
}

}  // namespace oraclegs
