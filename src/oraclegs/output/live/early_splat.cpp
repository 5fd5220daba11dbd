#include "oraclegs/output/live/early_splat.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "oraclegs/core/statistics.h"
#include "oraclegs/stages/start_points.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxPoints = 100000;
constexpr double kOpacity = 0.95;
constexpr double kSparseScale = 0.2, kDenseScale = 0.5;  // of the neighbors' distance: dots apart, and a closed surface
constexpr float kMaxScale = 3;                           // times the median: points far from all others are no balloons

/// Evenly spaced in their list.
PointCloud Thinned(const PointCloud& cloud) {
  const size_t n = std::min(cloud.xyz.size(), kMaxPoints);
  PointCloud thinned;
  for (size_t i = 0; i < n; ++i) {
    const size_t from = i * cloud.xyz.size() / n;
    thinned.xyz.push_back(cloud.xyz[from]);
    thinned.rgb.push_back(cloud.rgb[from]);
  }
  return thinned;
}

Gaussians Dots(const PointCloud& cloud, double scale) {
  if (cloud.xyz.size() < 2) return {};
  Gaussians dots = InitializeGaussians(Thinned(cloud), {scale, kOpacity});
  std::vector<float> scales(dots.log_scales.data(), dots.log_scales.data() + 3 * dots.size());
  const float largest = UpperMedian(scales) + std::log(kMaxScale);
  for (int64_t i = 0; i < 3 * dots.size(); ++i) dots.log_scales[i] = std::min(dots.log_scales[i], largest);
  return dots;
}

}  // namespace

EarlySplat EarlySplatOf(const Run& run, const std::string& stage) {
  const StageResults& results = *run.results;
  if (stage == "sfm") return {"sparse points", Dots(ToPointCloud(results.points), kSparseScale)};
  if (stage == "depth") return {"dense points", Dots(ToPointCloud(results.geometry.points), kDenseScale)};
  if (stage == "proxies" && !results.proxies.empty()) return {"draft model", results.proxies.front().gaussians};
  return {};
}

}  // namespace oraclegs
