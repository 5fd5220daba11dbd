#include "oraclegs/networks/seva/guidance.h"

#include <algorithm>

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

}  // namespace

Tensor GuidanceWeights(const std::vector<View>& views, const std::vector<bool>& given, double cfg) {
  if (views.size() != given.size() || std::find(given.begin(), given.end(), true) == given.end()) {
    throw ShapeError("GuidanceWeights: {} views and {} marks, of which one at least must be true", views.size(),
                     given.size());
  }
  std::vector<double> weights(views.size(), cfg);
  for (size_t i = 0; i < weights.size(); ++i) {
    if (IsClose(views, given, i)) weights[i] = kGuidanceBesideAnImage;
  }
  return torch::tensor(weights, torch::kDouble).to(torch::kFloat);
}

}  // namespace oraclegs::seva
