#include "oraclegs/baselines/weight_photos.h"

#include <algorithm>

#include "oraclegs/baselines/covisibility.h"
#include "oraclegs/train/constants.h"

namespace oraclegs {
namespace {

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
