#include "oraclegs/formats/spatial_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

constexpr int64_t kLeastShare = 64;  // a side has at least so much of the groups
// Gaussians this many times as far out as nine tenths of all, in whatever direction, have groups of their own: each
// would make the box of a group of others as large as the scene.
constexpr float kFar = 4;
constexpr int64_t kHalvedTo = 4;  // Gaussians whose order no file would notice

/// The largest distance along an axis of each Gaussian from the median of all.
std::vector<float> RadiiOf(const Buffer<float>& means, int64_t n) {
  std::vector<float> radii(static_cast<size_t>(n));
  for (int c = 0; c < 3; ++c) {
    std::vector<float> along;
    for (int64_t i = 0; i < n; ++i) along.push_back(means[3 * i + c]);
    const float middle = Median(along);
    for (int64_t i = 0; i < n; ++i) radii[i] = std::max(radii[i], std::abs(along[i] - middle));
  }
  return radii;
}

/// How many of the Gaussians go to the left: those below the middle of the box, so that a few far away end up among
/// themselves and not each in a group of others; but whole groups, and a share that ends the recursion soon.
int64_t CutOf(const Buffer<float>& means, const int64_t* begin, const int64_t* end, int axis, float middle) {
  const int64_t groups = (end - begin + kSpatialGroup - 1) / kSpatialGroup;
  const int64_t below = std::count_if(begin, end, [&](int64_t i) { return means[3 * i + axis] < middle; });
  const int64_t least = std::max<int64_t>(1, groups / kLeastShare);
  return std::clamp((below + kSpatialGroup / 2) / kSpatialGroup, least, groups - least) * kSpatialGroup;
}

/// Brings the indices [begin, end) in order.
void Halve(const Buffer<float>& means, int64_t* begin, int64_t* end) {
  const int64_t n = end - begin;
  if (n <= kHalvedTo) return;
  std::array<float, 3> low, high;
  low.fill(INFINITY);
  high.fill(-INFINITY);
  for (const int64_t* i = begin; i < end; ++i) {
    for (int c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], means[3 * *i + c]);
      high[c] = std::max(high[c], means[3 * *i + c]);
    }
  }
  int axis = 0;
  for (int c = 1; c < 3; ++c) {
    if (high[c] - low[c] > high[axis] - low[axis]) axis = c;
  }
  const int64_t left = n > kSpatialGroup ? CutOf(means, begin, end, axis, (low[axis] + high[axis]) / 2) : n / 2;
  // Ties go by index: the order must not depend on the standard library.
  std::nth_element(begin, begin + left, end, [&](int64_t a, int64_t b) {
    const float x = means[3 * a + axis], y = means[3 * b + axis];
    return x < y || (x == y && a < b);
  });
  Halve(means, begin, begin + left);
  Halve(means, begin + left, end);
}

}  // namespace

std::vector<int64_t> SpatialOrder(const Gaussians& gaussians) {
  const Buffer<float> means = gaussians.means.To(kCpu);
  const int64_t n = gaussians.size();
  std::vector<int64_t> order(static_cast<size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  const std::vector<float> radii = RadiiOf(means, n);
  std::stable_sort(order.begin(), order.end(), [&](int64_t a, int64_t b) { return radii[a] < radii[b]; });
  const float far = n > 0 ? kFar * radii[order[n * 9 / 10]] : 0;
  const int64_t inner =
      std::partition_point(order.begin(), order.end(), [&](int64_t i) { return radii[i] <= far; }) - order.begin();
  const int64_t near = inner == n ? n : inner / kSpatialGroup * kSpatialGroup;
  Halve(means, order.data(), order.data() + near);
  Halve(means, order.data() + near, order.data() + n);
  return order;
}

}  // namespace oraclegs
