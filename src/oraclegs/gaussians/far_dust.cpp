#include "oraclegs/gaussians/far_dust.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace oraclegs {
namespace {

constexpr int64_t kMinGaussians = 1000;
constexpr double kMiddle = 0.99;   // share of the Gaussians whose extent counts
constexpr float kFarExtents = 12;  // extents from the middle
// Far dust of nine scenes has opacities up to 0.03 and scales up to 0.011 of its distance.
constexpr float kMaxLogit = -2.2f;  // opacity 0.1
constexpr float kMaxScaleOfWay = 0.05f;

/// The value below which this share of an axis lies.
float Quantile(std::vector<float>* values, double share) {
  const auto at = values->begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values->size() - 1));
  std::nth_element(values->begin(), at, values->end());
  return *at;
}

}  // namespace

std::vector<int64_t> WithoutFarDust(const Gaussians& gaussians) {
  const Gaussians host = gaussians.To(kCpu);
  std::vector<int64_t> kept(static_cast<size_t>(host.size()));
  std::iota(kept.begin(), kept.end(), int64_t{0});
  if (host.size() < kMinGaussians) return kept;
  const Eigen::Map<const Eigen::Matrix<float, 3, Eigen::Dynamic>> means(host.means.data(), 3, host.size());
  const Eigen::Map<const Eigen::Matrix<float, 3, Eigen::Dynamic>> scales(host.log_scales.data(), 3, host.size());
  Eigen::Vector3f low, high;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> values(means.row(axis).begin(), means.row(axis).end());
    low[axis] = Quantile(&values, (1 - kMiddle) / 2);
    high[axis] = Quantile(&values, (1 + kMiddle) / 2);
  }
  const Eigen::Vector3f middle = (low + high) / 2;
  const float far = kFarExtents * (high - low).maxCoeff();
  std::erase_if(kept, [&](int64_t row) {
    const float way = (means.col(row) - middle).cwiseAbs().maxCoeff();
    return way > far && host.opacity_logits[row] < kMaxLogit &&
           std::exp(scales.col(row).maxCoeff()) < kMaxScaleOfWay * way;
  });
  return kept;
}

}  // namespace oraclegs
