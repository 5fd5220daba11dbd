#include "oraclegs/baselines/covisibility.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/train/constants.h"

namespace oraclegs {
namespace {

constexpr float kKnownDepth = 0.5f;  // of the mask

void CheckCovisibilityView(const CovisibilityView& view) {
  const Camera& camera = view.camera;
  if (view.inv_depth.defined()) {
    RequireShape("CovisibilityMap", "inv_depth", view.inv_depth, {camera.height, camera.width});
  }
  if (view.mask.defined()) RequireShape("CovisibilityMap", "mask", view.mask, {camera.height, camera.width});
}

/// Inverse depth of a pixel; 0 where it is unknown or the pixel is empty.
double KnownInvDepth(const CovisibilityView& view, int64_t pixel) {
  if (!view.inv_depth.defined() || (view.mask.defined() && !(view.mask[pixel] > kKnownDepth))) return 0;
  const auto inv_depth = static_cast<double>(view.inv_depth[pixel]);
  return inv_depth > 0 ? inv_depth : 0;
}

bool Sees(const CovisibilityView& view, const Eigen::Vector3d& world, double tolerance) {
  const Camera& camera = view.camera;
  const Eigen::Vector3d p = camera.cam_from_world * world;
  if (!(p.z() > 0)) return false;
  const double x = camera.fx * p.x() / p.z() + camera.cx, y = camera.fy * p.y() / p.z() + camera.cy;
  if (!(x >= 0 && y >= 0 && x < camera.width && y < camera.height)) return false;
  const int64_t pixel = static_cast<int64_t>(y) * camera.width + static_cast<int64_t>(x);
  const double inv_depth = KnownInvDepth(view, pixel);
  return inv_depth > 0 && std::abs(p.z() * inv_depth - 1) <= tolerance;
}

std::vector<CovisibilityView> DepthsOf(const std::vector<TrainView>& photos) {
  std::vector<CovisibilityView> views;
  for (const TrainView& photo : photos) {
    const TrainView clean = WithCleanDepth(photo);
    views.push_back({photo.camera, clean.inv_depth, clean.depth_mask});
  }
  return views;
}

bool IsKnownEmpty(const CovisibilityView& view, int64_t pixel) {
  return view.inv_depth.defined() && view.mask[pixel] > kTrustedDepth && !(view.inv_depth[pixel] > 0);
}

double ConfidenceAt(const TrainView& photo, int64_t pixel) {
  return photo.pixel_weight.defined() ? static_cast<double>(photo.pixel_weight[pixel]) : 1;
}

/// Factor that makes the mean of the weights 1.
double UnitOf(const std::vector<TrainView>& photos, const std::vector<CovisibilityView>& views,
              const std::vector<Buffer<float>>& weights) {
  double before = 0, after = 0;
  for (size_t v = 0; v < photos.size(); ++v) {
    for (int64_t i = 0; i < weights[v].count(); ++i) {
      if (IsKnownEmpty(views[v], i)) continue;
      before += ConfidenceAt(photos[v], i);
      after += ConfidenceAt(photos[v], i) * static_cast<double>(weights[v][i]);
    }
  }
  return after > 0 ? before / after : 1;
}

}  // namespace

Buffer<float> CovisibilityMap(const std::vector<CovisibilityView>& views, size_t index, double tolerance) {
  if (index >= views.size()) throw ShapeError("CovisibilityMap: view {} of {}", index, views.size());
  for (const CovisibilityView& view : views) CheckCovisibilityView(view);
  const CovisibilityView& own = views[index];
  const Camera& camera = own.camera;
  const Eigen::Isometry3d world_from_cam = camera.cam_from_world.inverse();
  Buffer<float> map = Buffer<float>::Zeros({camera.height, camera.width});
  ParallelFor(camera.height, [&](int64_t row) {
    for (int64_t column = 0; column < camera.width; ++column) {
      const int64_t pixel = row * camera.width + column;
      const double inv_depth = KnownInvDepth(own, pixel);
      if (!(inv_depth > 0)) continue;
      const Eigen::Vector3d ray((static_cast<double>(column) + 0.5 - camera.cx) / camera.fx,
                                (static_cast<double>(row) + 0.5 - camera.cy) / camera.fy, 1);
      const Eigen::Vector3d world = world_from_cam * (ray / inv_depth);
      for (size_t other = 0; other < views.size(); ++other) {
        if (other != index && Sees(views[other], world, tolerance)) map[pixel] += 1;
      }
    }
  });
  return map;
}

Buffer<float> CovisibilityWeights(const Buffer<float>& map) {
  RequireShape("CovisibilityWeights", "map", map, {-1, -1});
  Buffer<float> weights = Buffer<float>::Empty(map.shape());
  for (int64_t i = 0; i < map.count(); ++i) weights[i] = 1 / (map[i] + 1);
  return weights;
}

std::vector<TrainView> WeightByCovisibility(std::vector<TrainView> photos) {
  CheckViews(photos);
  const std::vector<CovisibilityView> views = DepthsOf(photos);
  if (std::none_of(views.begin(), views.end(), [](const CovisibilityView& v) { return v.inv_depth.defined(); })) {
    throw UsageError("weights by covisibility need the depth of the photos, none is known; use another --depth-prior");
  }
  std::vector<Buffer<float>> weights;
  for (size_t v = 0; v < views.size(); ++v) weights.push_back(CovisibilityWeights(CovisibilityMap(views, v)));
  const double unit = UnitOf(photos, views, weights);
  for (size_t v = 0; v < photos.size(); ++v) {
    for (int64_t i = 0; i < weights[v].count(); ++i) {
      const double weight = IsKnownEmpty(views[v], i) ? 1 : unit * static_cast<double>(weights[v][i]);
      weights[v][i] = static_cast<float>(ConfidenceAt(photos[v], i) * weight);
    }
    photos[v].pixel_weight = weights[v];
  }
  return photos;
}

}  // namespace oraclegs
