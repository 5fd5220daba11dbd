#include "oraclegs/datasets/point_file.h"

#include <algorithm>
#include <numeric>

#include "oraclegs/gaussians/initialize.h"
#include "oraclegs/scene/point_views.h"

namespace oraclegs {

void ReadPointFile(const Listener& listener, Scene* scene) {
  if (scene->point_file.empty()) return;
  const PointCloud cloud = ReadPointPly(scene->point_file);
  const size_t total = cloud.xyz.size();
  std::vector<ScenePoint> points(total);
  for (size_t i = 0; i < total; ++i) {
    points[i].xyz = cloud.xyz[i].cast<double>();
    for (int c = 0; c < 3; ++c) {
      points[i].rgb[static_cast<size_t>(c)] =
          static_cast<uint8_t>(std::clamp(cloud.rgb[i](c) * 255 + 0.5f, 0.f, 255.f));
    }
  }
  std::vector<size_t> all(total);
  std::iota(all.begin(), all.end(), 0);
  FindViewsOfPoints(all, *scene, &points);
  const size_t unseen = std::erase_if(points, [](const ScenePoint& point) { return point.views.empty(); });
  const std::string source = scene->point_file.string();
  ReportUntracked(source, total, total, listener);
  ReportPointsLeftOut(source, unseen, total, listener);
  scene->points.insert(scene->points.end(), points.begin(), points.end());
}

}  // namespace oraclegs
