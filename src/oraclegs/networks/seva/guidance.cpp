#include "oraclegs/networks/seva/guidance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace oraclegs::seva {
namespace {

constexpr double kCloseDegrees = 10, kCloseDistance = 1e-5;

/// True when some conditioning frame is near in rotation, some in position, and some in zoom; not necessarily the same
/// one.
bool IsClose(const std::vector<View>& views, const std::vector<bool>& given, size_t frame) {
  const View& view = views[frame];
  bool turned = false, moved = false, zoomed = false;
  for (size_t i = 0; i < views.size(); ++i) {
    if (!given[i]) continue;
    turned |= RotationDegrees(view.world_from_camera.linear(), views[i].world_from_camera.linear()) < kCloseDegrees;
    moved |= (view.center() - views[i].center()).norm() < kCloseDistance;
    zoomed |= view.intrinsics == views[i].intrinsics;
  }
  return turned && moved && zoomed;
}

/// Distance in frames to the nearest conditioning frame, divided by the largest such distance.
std::vector<double> TemporalDistances(const std::vector<bool>& given) {
  std::vector<double> distances;
  const auto count = static_cast<int64_t>(given.size());
  for (int64_t t = 0; t < count; ++t) {
    int64_t nearest = count;
    for (int64_t j = 0; j < count; ++j) {
      if (given[static_cast<size_t>(j)]) nearest = std::min(nearest, std::abs(t - j));
    }
    distances.push_back(static_cast<double>(nearest));
  }
  const double farthest = std::max(*std::max_element(distances.begin(), distances.end()), 1.0);
  for (double& distance : distances) distance /= farthest;
  return distances;
}

}  // namespace

Tensor GuidanceWeights(const std::vector<View>& views, const std::vector<bool>& given, const Guidance& guidance) {
  if (views.size() != given.size() || std::find(given.begin(), given.end(), true) == given.end()) {
    throw ShapeError("GuidanceWeights: {} views and {} marks, of which one at least must be true", views.size(),
                     given.size());
  }
  std::vector<double> weights(views.size(), guidance.cfg);
  if (guidance.guider == Guider::kTemporal) {
    const std::vector<double> distances = TemporalDistances(given);
    for (size_t i = 0; i < weights.size(); ++i) {
      weights[i] = guidance.cfg_min + distances[i] * (guidance.cfg - guidance.cfg_min);
    }
  }
  for (size_t i = 0; i < weights.size() && guidance.guider != Guider::kPlain; ++i) {
    if (IsClose(views, given, i)) weights[i] = guidance.cfg_min;
  }
  return torch::tensor(weights, torch::kDouble).to(torch::kFloat);
}

}  // namespace oraclegs::seva
