#include "oraclegs/gaussians/neighbors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr int64_t kLeafItems = 12;     // at most; about where scanning and descending cost the same
constexpr int64_t kQueryGrain = 1024;  // queries a task
constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr int kTopLevels = 6;  // split one after the other; the 64 subtrees below are then built side by side

}  // namespace

/// One query, and how far it lies outside the visited node's cell on each axis. What is found is the derived search's.
struct KdTree::Search {
  Eigen::Vector3d query;
  int64_t self;  ///< place in items_ of the query itself, -1 where it is none of them
  std::array<double, 3> outside{0, 0, 0};

  /// Summed in the order of a squared distance, so that rounding never makes the bound exceed one.
  double Bound() const { return outside[0] * outside[0] + outside[1] * outside[1] + outside[2] * outside[2]; }
};

/// The squared distances of the three nearest so far.
struct KdTree::MeanSearch : Search {
  std::array<double, 3> nearest{kFar, kFar, kFar};

  double Limit() const { return nearest[2]; }
  void Offer(const Item&, double d2) {
    if (d2 >= nearest[2]) return;
    nearest[2] = d2;
    if (nearest[2] < nearest[1]) std::swap(nearest[1], nearest[2]);
    if (nearest[1] < nearest[0]) std::swap(nearest[0], nearest[1]);
  }
};

/// A search that also keeps which points the three nearest are.
struct KdTree::ThreeSearch : Search {
  std::array<NearPoint, 3> nearest;

  double Limit() const { return nearest[2].squared_distance; }
  void Offer(const Item& item, double d2) {
    if (d2 >= Limit()) return;
    nearest[2] = {item.source, d2};
    for (size_t k = 2; k > 0 && nearest[k].squared_distance < nearest[k - 1].squared_distance; --k) {
      std::swap(nearest[k], nearest[k - 1]);
    }
  }
};

/// Whether any point is nearer than the limit. Once one is, no further cell is.
struct KdTree::WithinSearch : Search {
  double limit = 0;
  bool found = false;

  double Limit() const { return found ? -1 : limit; }
  void Offer(const Item&, double d2) { found |= d2 < limit; }
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

template <class S>
void KdTree::Visit(int level, int64_t node, S* search) const {
  if (level == levels_) {
    const auto [begin, end] = RangeOf(level, node);
    for (int64_t i = begin; i < end; ++i) {
      if (i == search->self) continue;
      const Eigen::Vector3d d = items_[i].xyz.cast<double>() - search->query;
      search->Offer(items_[i], d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }
    return;
  }
  const Node& inner = nodes_[(int64_t{1} << level) - 1 + node];
  const double away = search->query[inner.axis] - static_cast<double>(inner.split);
  const int64_t near = 2 * node + (away > 0 ? 1 : 0), far = near ^ 1;
  Visit(level + 1, near, search);
  const double before = search->outside[inner.axis];
  search->outside[inner.axis] = away;
  if (search->Bound() < search->Limit()) Visit(level + 1, far, search);
  search->outside[inner.axis] = before;
}

std::vector<double> KdTree::MeanSquaredDistanceToThree() const {
  const auto n = static_cast<int64_t>(items_.size());
  std::vector<double> means(items_.size(), 0.0);
  const int64_t others = std::min<int64_t>(3, n - 1);
  if (others <= 0) return means;
  ParallelBlocks(n, kQueryGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      MeanSearch search{{items_[i].xyz.cast<double>(), i}};
      Visit(0, 0, &search);
      double sum = 0;
      for (int64_t k = 0; k < others; ++k) sum += search.nearest[k];
      means[items_[i].source] = sum / static_cast<double>(others);
    }
  });
  return means;
}

std::vector<std::array<NearPoint, 3>> KdTree::ThreeNearest() const {
  std::vector<std::array<NearPoint, 3>> nearest(items_.size());
  ParallelBlocks(static_cast<int64_t>(items_.size()), kQueryGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      ThreeSearch search{{items_[i].xyz.cast<double>(), i}, {}};
      Visit(0, 0, &search);
      nearest[items_[i].source] = search.nearest;
    }
  });
  return nearest;
}

bool KdTree::HasWithin(const Eigen::Vector3f& query, double radius) const {
  // Just above the square, so that the radius itself is within.
  WithinSearch search{{query.cast<double>(), -1}, std::nextafter(radius * radius, kFar)};
  Visit(0, 0, &search);
  return search.found;
}

}  // namespace oraclegs
