#include "oraclegs/depth/gains.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

constexpr size_t kStride = 5;                          // pixels; no divisor of usual widths
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

/// Color ratios of view a over view b.
Ratio Compare(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views, size_t a, size_t b) {
  const PixelMap there = MapBetween(maps[a].camera, maps[b].camera), back = MapBetween(maps[b].camera, maps[a].camera);
  std::vector<double> logs[3];
  for (size_t i = 0; i < maps[a].size(); i += kStride) {
    if (maps[a].confidence[i] < kConfident) continue;
    const auto j = FindPixel(maps[b], there, back, PixelOf(maps[a], i), {});
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
  std::vector<Ratio> ratios(n * n);
  ParallelFor(static_cast<int64_t>(n * n), [&](int64_t k) {
    const size_t a = static_cast<size_t>(k) / n, b = static_cast<size_t>(k) % n;
    if (a != b) ratios[static_cast<size_t>(k)] = Compare(maps, views, a, b);
  });
  const auto size = static_cast<int64_t>(n);
  Eigen::MatrixXd normal = kGainRidge * Eigen::MatrixXd::Identity(size, size);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(size, 3);
  for (int64_t a = 0; a < size; ++a) {
    for (int64_t b = 0; b < size; ++b) {
      const Ratio& ratio = ratios[static_cast<size_t>(a * size + b)];
      if (ratio.pixels == 0) continue;
      normal(a, a) += 1, normal(b, b) += 1, normal(a, b) -= 1, normal(b, a) -= 1;
      right.row(a) += ratio.log.transpose();
      right.row(b) -= ratio.log.transpose();
    }
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
