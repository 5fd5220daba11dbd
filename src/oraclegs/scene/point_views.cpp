#include "oraclegs/scene/point_views.h"

#include <fmt/format.h>

#include "oraclegs/camera/undistort.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs {

void FindViewsOfPoints(const std::vector<size_t>& which, const Scene& scene, std::vector<ScenePoint>* points) {
  std::vector<Camera> cameras;
  for (const SceneView& view : scene.views) {
    cameras.push_back(UndistortedCamera(view.intrinsics));
    cameras.back().cam_from_world = *view.cam_from_world;
  }
  ParallelFor(static_cast<int64_t>(which.size()), [&](int64_t i) {
    ScenePoint& point = (*points)[which[static_cast<size_t>(i)]];
    for (size_t v = 0; v < cameras.size(); ++v) {
      const Camera& camera = cameras[v];
      const Eigen::Vector3d p = camera.cam_from_world * point.xyz;
      const double x = camera.fx * p.x() + camera.cx * p.z(), y = camera.fy * p.y() + camera.cy * p.z();
      const bool inside = p.z() > 0 && x >= 0 && y >= 0 && x <= camera.width * p.z() && y <= camera.height * p.z();
      if (inside) point.views.push_back(static_cast<int>(v));
    }
  });
}

void ReportUntracked(const std::string& source, size_t count, size_t total, const Listener& listener) {
  if (count == 0) return;
  listener(Note{fmt::format(
      "{}: {} of {} points have no track that says which photos saw them; each counts as seen by the photos it falls "
      "into, and training starts from them where all photos train, or with --set sfm-points=model",
      source, count, total)});
}

void ReportPointsLeftOut(const std::string& source, size_t count, size_t total, const Listener& listener) {
  if (count == 0) return;
  listener(Warning{fmt::format("{}: {} of {} points are left out: not finite, or seen by no photo that is here", source,
                               count, total)});
}

}  // namespace oraclegs
