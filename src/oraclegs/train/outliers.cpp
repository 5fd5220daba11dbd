#include "oraclegs/train/outliers.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "oraclegs/core/parallel.h"
#include "oraclegs/render/constants.h"
#include "oraclegs/train/train_math.h"

namespace oraclegs {
namespace {

constexpr int64_t kFloaterGrain = 1024;  // Gaussians a task

/// z times the inverse depth under a point: 1 on the surface, less before it, 0 where the pixel is empty. nullopt where
/// the view contributes no vote.
std::optional<double> DepthRatio(const TrainView& view, const Eigen::Vector3d& world) {
  const Camera& camera = view.camera;
  const Eigen::Vector3d point = camera.cam_from_world * world;
  if (!(point.z() > static_cast<double>(kNearPlane))) return std::nullopt;
  const double x = camera.fx * point.x() / point.z() + camera.cx, y = camera.fy * point.y() / point.z() + camera.cy;
  if (!(x >= 0 && y >= 0 && x < camera.width && y < camera.height)) return std::nullopt;
  const int64_t pixel = static_cast<int64_t>(y) * camera.width + static_cast<int64_t>(x);
  if (!(view.depth_mask.data()[pixel] > kTrustedDepth)) return std::nullopt;
  return point.z() * static_cast<double>(view.inv_depth.data()[pixel]);
}

bool IsFloater(const std::vector<TrainView>& views, const Eigen::Vector3d& world) {
  FloaterVotes votes;
  for (const TrainView& view : views) {
    if (!view.inv_depth.defined()) continue;
    if (const std::optional<double> ratio = DepthRatio(view, world)) votes.Add(*ratio);
  }
  return votes.IsFloater();
}

bool IsAlive(float logit) { return OpacityOf(logit) > static_cast<double>(kDeadOpacity); }

constexpr int64_t kScaleCapGrain = 4096;  // Gaussians a task

}  // namespace

int64_t PruneFloaters(const std::vector<TrainView>& views, Gaussians* gaussians) {
  gaussians->Check("PruneFloaters");
  const int64_t n = gaussians->size();
  const float* means = gaussians->means.data();
  float* logits = gaussians->opacity_logits.data();
  std::vector<uint8_t> alive(n), floats(n);
  ParallelBlocks(n, kFloaterGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      alive[i] = IsAlive(logits[i]);
      const float* mean = means + 3 * i;
      floats[i] = alive[i] && IsFloater(views, Eigen::Vector3f(mean[0], mean[1], mean[2]).cast<double>());
    }
  });
  const int64_t living = std::accumulate(alive.begin(), alive.end(), int64_t{0});
  const int64_t floating = std::accumulate(floats.begin(), floats.end(), int64_t{0});
  if (floating == living) return 0;
  for (int64_t i = 0; i < n; ++i) {
    if (floats[i]) logits[i] = kPrunedLogit;
  }
  return floating;
}

std::vector<float> CameraCenters(const std::vector<TrainView>& views) {
  std::vector<float> centers;
  for (const TrainView& view : views) {
    const Eigen::Vector3f center = view.camera.Center().cast<float>();
    centers.insert(centers.end(), center.data(), center.data() + 3);
  }
  return centers;
}

void CapScales(const std::vector<float>& centers, double share, Gaussians* gaussians) {
  gaussians->Check("CapScales");
  if (centers.empty()) return;
  const GaussianRows rows = gaussians->Rows();
  const auto log_share = static_cast<float>(std::log(share));
  const auto count = static_cast<int>(centers.size() / 3);
  ParallelBlocks(gaussians->size(), kScaleCapGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      const float cap = LogScaleCap(rows.means + 3 * i, centers.data(), count, log_share);
      for (int64_t k = 3 * i; k < 3 * i + 3; ++k) rows.log_scales[k] = std::min(rows.log_scales[k], cap);
    }
  });
}

}  // namespace oraclegs
