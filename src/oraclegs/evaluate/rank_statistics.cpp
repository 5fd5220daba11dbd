#include "oraclegs/evaluate/rank_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace oraclegs {

std::vector<int64_t> RisingOrder(const std::vector<float>& values) {
  std::vector<int64_t> order(values.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int64_t a, int64_t b) { return values[a] != values[b] ? values[a] < values[b] : a < b; });
  return order;
}

std::vector<double> Ranks(const std::vector<float>& values) {
  const std::vector<int64_t> order = RisingOrder(values);
  std::vector<double> ranks(values.size());
  ForEachTie(values, order, [&](int64_t begin, int64_t end) {
    for (int64_t k = begin; k < end; ++k) ranks[order[k]] = 0.5 * static_cast<double>(begin + 1 + end);
  });
  return ranks;
}

double Correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  const double mean_a = std::accumulate(a.begin(), a.end(), 0.0) / n;
  const double mean_b = std::accumulate(b.begin(), b.end(), 0.0) / n;
  double aa = 0, bb = 0, ab = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double x = a[i] - mean_a, y = b[i] - mean_b;
    aa += x * x, bb += y * y, ab += x * y;
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

double AurocOfLowRank(const std::vector<double>& ranks, const std::vector<bool>& positive) {
  double negatives = 0, rank_sum = 0;
  for (size_t i = 0; i < ranks.size(); ++i) {
    if (positive[i]) continue;
    ++negatives;
    rank_sum += ranks[i];
  }
  const double positives = static_cast<double>(ranks.size()) - negatives;
  if (negatives == 0 || positives == 0) return std::numeric_limits<double>::quiet_NaN();
  return (rank_sum - negatives * (negatives + 1) / 2) / (negatives * positives);
}

}  // namespace oraclegs
