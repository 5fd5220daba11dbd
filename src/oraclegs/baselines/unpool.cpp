#include "oraclegs/baselines/unpool.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "oraclegs/gaussians/neighbors.h"

namespace oraclegs {
namespace {

struct Scored {
  double score;
  int64_t row;
};

struct UnpoolEdge {
  int64_t source, destination;
};

std::vector<Eigen::Vector3f> CentersOf(const Gaussians& gaussians) {
  std::vector<Eigen::Vector3f> centers(static_cast<size_t>(gaussians.size()));
  for (int64_t i = 0; i < gaussians.size(); ++i) centers[i] = Eigen::Vector3f::Map(gaussians.means.data() + 3 * i);
  return centers;
}

double ProximityScore(const std::array<NearPoint, 3>& nearest) {
  double sum = 0;
  for (const NearPoint& near : nearest) sum += near.squared_distance;
  return sum / static_cast<double>(nearest.size());
}

bool IsLarge(const ProximityLimits& limits, const Gaussians& gaussians, int64_t i) {
  const float* scales = gaussians.log_scales.data() + 3 * i;
  return std::exp(static_cast<double>(*std::max_element(scales, scales + 3))) > limits.scale;
}

using Neighbors = std::vector<std::array<NearPoint, 3>>;

/// Nearest neighbors of each Gaussian; empty where no Gaussian can exceed the limits.
Neighbors NeighborsOf(const ProximityLimits& limits, const Gaussians& gaussians) {
  const int64_t n = gaussians.size();
  bool any = false;
  for (int64_t i = 0; i < n && !any; ++i) any = IsLarge(limits, gaussians, i);
  if (!any || n < 4) return {};
  return KdTree(CentersOf(gaussians)).ThreeNearest();
}

std::vector<int64_t> Isolated(const ProximityLimits& limits, const Gaussians& gaussians, const Neighbors& nearest) {
  std::vector<Scored> isolated;
  for (size_t i = 0; i < nearest.size(); ++i) {
    const double score = ProximityScore(nearest[i]);
    const auto row = static_cast<int64_t>(i);
    if (score > limits.score && IsLarge(limits, gaussians, row)) isolated.push_back({score, row});
  }
  std::stable_sort(isolated.begin(), isolated.end(),
                   [](const Scored& a, const Scored& b) { return a.score > b.score; });
  std::vector<int64_t> rows;
  for (const Scored& one : isolated) rows.push_back(one.row);
  return rows;
}

void FillMiddle(const UnpoolEdge& edge, int64_t to, Gaussians* gaussians) {
  const Buffer<float>&means = gaussians->means, &scales = gaussians->log_scales;
  for (int axis = 0; axis < 3; ++axis) {
    means[3 * to + axis] = 0.5f * (means[3 * edge.source + axis] + means[3 * edge.destination + axis]);
    scales[3 * to + axis] = scales[3 * edge.destination + axis];
  }
  constexpr std::array<float, 4> kNoRotation = {1, 0, 0, 0};
  std::copy(kNoRotation.begin(), kNoRotation.end(), gaussians->quats.data() + 4 * to);
  gaussians->opacity_logits[to] = gaussians->opacity_logits[edge.destination];
  std::fill_n(gaussians->sh.data() + kShFloats * to, kShFloats, 0.f);
}

}  // namespace

std::vector<int64_t> IsolatedGaussians(const ProximityLimits& limits, const Gaussians& gaussians) {
  return Isolated(limits, gaussians, NeighborsOf(limits, gaussians));
}

int64_t UnpoolGaussians(const ProximityLimits& limits, int64_t max_gaussians, Gaussians* gaussians) {
  gaussians->Check("UnpoolGaussians");
  const int64_t n = gaussians->size();
  if (n >= max_gaussians) return 0;
  const Neighbors nearest = NeighborsOf(limits, *gaussians);
  std::vector<UnpoolEdge> edges;
  for (const int64_t source : Isolated(limits, *gaussians, nearest)) {
    for (const NearPoint& near : nearest[source]) edges.push_back({source, near.index});
  }
  const int64_t added = std::min<int64_t>(static_cast<int64_t>(edges.size()), max_gaussians - n);
  if (added == 0) return 0;
  gaussians->ForEach([&](const char*, Buffer<float>& t) { t = t.GrownTo(n + added); });
  for (int64_t k = 0; k < added; ++k) FillMiddle(edges[k], n + k, gaussians);
  return added;
}

}  // namespace oraclegs
