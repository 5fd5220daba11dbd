#include "oraclegs/train/scale_cap.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/train/train_math.h"

namespace oraclegs {
namespace {

constexpr int64_t kScaleCapGrain = 4096;  // Gaussians a task

}  // namespace

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
