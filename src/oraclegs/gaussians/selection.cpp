#include "oraclegs/gaussians/selection.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

float Presence(const Gaussians& gaussians, int64_t i) {
  const float* scales = gaussians.log_scales.data() + 3 * i;
  const float smallest = std::min({scales[0], scales[1], scales[2]});
  const float presence = Sigmoid(gaussians.opacity_logits[i]) * std::exp(scales[0] + scales[1] + scales[2] - smallest);
  return std::isnan(presence) ? 0 : presence;  // nothing of an infinite size
}

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

Gaussians Picked(const Gaussians& gaussians, const std::vector<int64_t>& indices) {
  Gaussians picked = gaussians.To(kCpu);
  picked.ForEach([&](const char*, Buffer<float>& part) { part = PickedRows(part, indices); });
  return picked;
}

GaussianMarks Picked(const GaussianMarks& marks, const std::vector<int64_t>& indices) {
  GaussianMarks picked;
  for (const auto list : {&GaussianMarks::support, &GaussianMarks::uncertainty}) {
    if ((marks.*list).empty()) continue;
    for (const int64_t i : indices) (picked.*list).push_back((marks.*list)[static_cast<size_t>(i)]);
  }
  return picked;
}

std::vector<int64_t> MostPresent(const Gaussians& gaussians, std::vector<int64_t> indices, int64_t most) {
  if (static_cast<int64_t>(indices.size()) <= most) return indices;
  std::vector<std::pair<float, size_t>> ranked;  // by presence, with the place among the indices
  for (size_t k = 0; k < indices.size(); ++k) ranked.emplace_back(Presence(gaussians, indices[k]), k);
  std::nth_element(ranked.begin(), ranked.begin() + most, ranked.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });
  std::vector<size_t> places;
  for (int64_t k = 0; k < most; ++k) places.push_back(ranked[static_cast<size_t>(k)].second);
  std::sort(places.begin(), places.end());
  std::vector<int64_t> kept;
  for (const size_t place : places) kept.push_back(indices[place]);
  return kept;
}

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
