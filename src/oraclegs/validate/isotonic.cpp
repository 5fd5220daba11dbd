#include "oraclegs/validate/isotonic.h"

#include <algorithm>
#include <cstddef>

namespace oraclegs {
namespace {

constexpr size_t kSteps = 200;  // groups of neighboring x that are pooled first against noise

struct Pool {
  double x = 0, y = 0, count = 0;  // sums
  double MeanY() const { return y / count; }
};

}  // namespace

Isotonic Isotonic::Fit(std::vector<std::pair<float, float>> samples) {
  std::sort(samples.begin(), samples.end());
  std::vector<Pool> pools;
  const size_t group = std::max<size_t>(1, samples.size() / kSteps);
  for (size_t first = 0; first < samples.size();) {
    size_t last = std::min(samples.size(), first + group);
    while (last < samples.size() && samples[last].first == samples[last - 1].first) ++last;
    Pool pool;
    for (; first < last; ++first) {
      pool.x += static_cast<double>(samples[first].first);
      pool.y += static_cast<double>(samples[first].second);
      pool.count += 1;
    }
    while (!pools.empty() && pools.back().MeanY() >= pool.MeanY()) {
      pool.x += pools.back().x, pool.y += pools.back().y, pool.count += pools.back().count;
      pools.pop_back();
    }
    pools.push_back(pool);
  }
  Isotonic map;
  for (const Pool& pool : pools) {
    map.x_.push_back(static_cast<float>(pool.x / pool.count));
    map.y_.push_back(static_cast<float>(pool.MeanY()));
  }
  return map;
}

float Isotonic::operator()(float x) const {
  if (x_.empty()) return x;
  const auto above = std::upper_bound(x_.begin(), x_.end(), x);
  if (above == x_.begin()) return y_.front();
  if (above == x_.end()) return y_.back();
  const auto k = static_cast<size_t>(above - x_.begin());
  const float t = (x - x_[k - 1]) / (x_[k] - x_[k - 1]);
  return (1 - t) * y_[k - 1] + t * y_[k];
}

}  // namespace oraclegs
