#include "oraclegs/gaussians/neighbors.h"

#include <algorithm>
#include <array>
#include <limits>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr int64_t kLeafItems = 12;     // at most; about where scanning and descending cost the same
constexpr int64_t kQueryGrain = 1024;  // queries a task
constexpr int kTopLevels = 6;          // split one after the other; the 64 subtrees below are then built side by side

}  // namespace

/// One query: the three nearest so far, and how far the query lies outside the visited node's cell on each axis.
struct KdTree::Search {
  Eigen::Vector3d query;
  int64_t self;  ///< place in items_ of the query itself
  std::array<double, 3> nearest;
  std::array<double, 3> outside{0, 0, 0};

  void Offer(double d2) {
    if (d2 >= nearest[2]) return;
    nearest[2] = d2;
    if (nearest[2] < nearest[1]) std::swap(nearest[1], nearest[2]);
    if (nearest[1] < nearest[0]) std::swap(nearest[0], nearest[1]);
  }
  /// Summed in the order of a squared distance, so that rounding never makes the bound exceed one.
  double Bound() const { return outside[0] * outside[0] + outside[1] * outside[1] + outside[2] * outside[2]; }
};

KdTree::KdTree(const std::vector<Eigen::Vector3f>& points) {
  const auto n = static_cast<int64_t>(points.size());
  items_.resize(points.size());
  for (int64_t i = 0; i < n; ++i) items_[i] = {points[i], i};
  while ((n >> levels_) > kLeafItems) ++levels_;
  nodes_.resize((size_t{1} << levels_) - 1);
  const int top = std::min(levels_, kTopLevels);
  for (int level = 0; level < top; ++level) {
    ParallelFor(int64_t{1} << level, [&](int64_t node) { Split(level, node); });
  }
  ParallelFor(int64_t{1} << top, [&](int64_t root) {
    for (int down = 0; top + down < levels_; ++down) {
      for (int64_t j = 0; j < int64_t{1} << down; ++j) Split(top + down, (root << down) + j);
    }
  });
}

KdTree::Range KdTree::RangeOf(int level, int64_t node) const {
  const auto n = static_cast<int64_t>(items_.size());
  return {n * node >> level, n * (node + 1) >> level};
}

void KdTree::Split(int level, int64_t node) {
  const auto [begin, end] = RangeOf(level, node);
  const int64_t middle = RangeOf(level + 1, 2 * node + 1).begin;
  Eigen::Array3f low = items_[begin].xyz, high = low;
  for (int64_t i = begin; i < end; ++i) {
    low = low.min(items_[i].xyz.array());
    high = high.max(items_[i].xyz.array());
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end,
                   [axis](const Item& a, const Item& b) { return a.xyz[axis] < b.xyz[axis]; });
  nodes_[(int64_t{1} << level) - 1 + node] = {items_[middle].xyz[axis], axis};
}

void KdTree::Visit(int level, int64_t node, Search* search) const {
  if (level == levels_) {
    const auto [begin, end] = RangeOf(level, node);
    for (int64_t i = begin; i < end; ++i) {
      if (i == search->self) continue;
      const Eigen::Vector3d d = items_[i].xyz.cast<double>() - search->query;
      search->Offer(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }
    return;
  }
  const Node& inner = nodes_[(int64_t{1} << level) - 1 + node];
  const double away = search->query[inner.axis] - static_cast<double>(inner.split);
  const int64_t near = 2 * node + (away > 0 ? 1 : 0), far = near ^ 1;
  Visit(level + 1, near, search);
  const double before = search->outside[inner.axis];
  search->outside[inner.axis] = away;
  if (search->Bound() < search->nearest[2]) Visit(level + 1, far, search);
  search->outside[inner.axis] = before;
}

std::vector<double> KdTree::MeanSquaredDistanceToThree() const {
  const auto n = static_cast<int64_t>(items_.size());
  std::vector<double> means(items_.size(), 0.0);
  const int64_t others = std::min<int64_t>(3, n - 1);
  if (others <= 0) return means;
  ParallelBlocks(n, kQueryGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      Search search{items_[i].xyz.cast<double>(), i, {}};
      search.nearest.fill(std::numeric_limits<double>::infinity());
      Visit(0, 0, &search);
      double sum = 0;
      for (int64_t k = 0; k < others; ++k) sum += search.nearest[k];
      means[items_[i].source] = sum / static_cast<double>(others);
    }
  });
  return means;
}

}  // namespace oraclegs
