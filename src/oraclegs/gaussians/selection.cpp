#include "oraclegs/gaussians/selection.h"

#include <algorithm>
#include <cmath>
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

}  // namespace

Gaussians Picked(const Gaussians& gaussians, const std::vector<int64_t>& indices) {
  Gaussians picked = gaussians.To(kCpu);
  picked.ForEach([&](const char*, Buffer<float>& part) { part = PickedRows(part, indices); });
  return picked;
}

std::vector<float> Picked(const std::vector<float>& support, const std::vector<int64_t>& indices) {
  std::vector<float> picked;
  if (support.empty()) return picked;
  for (const int64_t i : indices) picked.push_back(support[static_cast<size_t>(i)]);
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

}  // namespace oraclegs
