#include "oraclegs/depth/gains.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/depth/nearest_sources.h"

namespace oraclegs {
namespace {

constexpr size_t kStride = 5;                          // pixels; no divisor of usual widths
constexpr size_t kMaxCompared = 10;                    // views that a view is compared with
constexpr size_t kMinCommonPixels = 50;                // of a pair
constexpr float kDarkest = 0.08f, kBrightest = 0.92f;  // beyond, noise and saturation dominate
constexpr double kGainRidge = 1e-3;                    // regularization toward gain 1, in shares of a pair's weight

/// Median log ratios of one pair, and the number of pixels behind them.
struct Ratio {
  Eigen::Vector3d log = Eigen::Vector3d::Zero();
  size_t pixels = 0;
};

bool IsUsable(const float* rgb) {
  for (int c = 0; c < 3; ++c) {
    if (rgb[c] < kDarkest || rgb[c] > kBrightest) return false;
  }
  return true;
}

/// The pixel that shows the same point: where it is certain, or where nothing is known of the other view's depth. The
/// few pixels where something else hides the point do not move a median.
std::optional<size_t> SamePixel(const DepthMap& other, const PixelMap& there, const PixelMap& back,
                                const Eigen::Vector3f& uvw) {
  if (other.size() > 0) return FindPixel(other, there, back, uvw, {});
  const Eigen::Vector3f q = there(uvw.x(), uvw.y(), uvw.z());
  const float u = q.x() / q.z(), v = q.y() / q.z();
  const Camera& camera = other.camera;
  const bool in_frame =
      q.z() > 0 && u >= 0 && v >= 0 && u < static_cast<float>(camera.width) && v < static_cast<float>(camera.height);
  if (!in_frame) return std::nullopt;
  return static_cast<size_t>(v) * static_cast<size_t>(camera.width) + static_cast<size_t>(u);
}

/// Color ratios of view a, which has depth, over view b.
Ratio Compare(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views, size_t a, size_t b) {
  const PixelMap there = MapBetween(maps[a].camera, maps[b].camera), back = MapBetween(maps[b].camera, maps[a].camera);
  std::vector<double> logs[3];
  for (size_t i = 0; i < maps[a].size(); i += kStride) {
    if (maps[a].confidence[i] < kConfident) continue;
    const auto j = SamePixel(maps[b], there, back, PixelOf(maps[a], i));
    if (!j) continue;
    const float* from = views[a].rgb.data.data() + 3 * i;
    const float* to = views[b].rgb.data.data() + 3 * *j;
    if (!IsUsable(from) || !IsUsable(to)) continue;
    for (int c = 0; c < 3; ++c) logs[c].push_back(std::log(static_cast<double>(from[c]) / static_cast<double>(to[c])));
  }
  Ratio ratio;
  ratio.pixels = logs[0].size();
  if (ratio.pixels < kMinCommonPixels) return {};
  for (int c = 0; c < 3; ++c) ratio.log[c] = UpperMedian(&logs[c]);
  return ratio;
}

}  // namespace

std::vector<Eigen::Vector3f> EstimateGains(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views) {
  const size_t n = maps.size();
  const NearestSources nearest(maps);
  struct Pair {
    int64_t a, b;
    Ratio ratio = {};
  };
  std::vector<Pair> pairs;
  for (size_t b = 0; b < n; ++b) {
    for (const size_t a : nearest.For(maps[b].camera, kMaxCompared, b)) {
      pairs.push_back({static_cast<int64_t>(a), static_cast<int64_t>(b)});
    }
  }
  ParallelFor(static_cast<int64_t>(pairs.size()), [&](int64_t k) {
    Pair& pair = pairs[static_cast<size_t>(k)];
    pair.ratio = Compare(maps, views, static_cast<size_t>(pair.a), static_cast<size_t>(pair.b));
  });
  const auto size = static_cast<int64_t>(n);
  Eigen::MatrixXd normal = kGainRidge * Eigen::MatrixXd::Identity(size, size);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(size, 3);
  for (const auto& [a, b, ratio] : pairs) {
    if (ratio.pixels == 0) continue;
    normal(a, a) += 1, normal(b, b) += 1, normal(a, b) -= 1, normal(b, a) -= 1;
    right.row(a) += ratio.log.transpose();
    right.row(b) -= ratio.log.transpose();
  }
  if (n == 0) return {};
  Eigen::MatrixXd logs = normal.ldlt().solve(right);
  logs.rowwise() -= logs.colwise().mean().eval();
  std::vector<Eigen::Vector3f> gains;
  for (int64_t v = 0; v < size; ++v) gains.push_back(logs.row(v).array().exp().matrix().transpose().cast<float>());
  return gains;
}

double ExposureSpread(const std::vector<Eigen::Vector3f>& gains) {
  double sum = 0;
  for (const Eigen::Vector3f& gain : gains) sum += gain.cast<double>().array().log().square().sum();
  return gains.empty() ? 0 : std::sqrt(sum / (3 * static_cast<double>(gains.size())));
}

}  // namespace oraclegs
