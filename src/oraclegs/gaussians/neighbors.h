#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace oraclegs {

/// Static k-d tree over points in space: a complete binary tree whose node ranges follow from the number of points
/// alone, so that it needs no links.
class KdTree {
 public:
  /// Builds on all threads. Coordinates must be finite.
  explicit KdTree(const std::vector<Eigen::Vector3f>& points);

  /// Mean squared distance of each point, in the order given to the constructor, to its three nearest others (to all
  /// others when there are fewer; 0 when there are none). Exact; a duplicate is at distance 0. On all threads.
  std::vector<double> MeanSquaredDistanceToThree() const;

 private:
  struct Item {
    Eigen::Vector3f xyz;
    int64_t source;  ///< place in the constructor's order
  };
  struct Node {
    float split = 0;  ///< items left of it are <= split, right of it >= split
    int axis = 0;
  };
  struct Range {
    int64_t begin, end;
  };
  struct Search;

  Range RangeOf(int level, int64_t node) const;
  void Split(int level, int64_t node);
  void Visit(int level, int64_t node, Search* search) const;

  std::vector<Item> items_;
  std::vector<Node> nodes_;  ///< level by level: node j of level l at 2^l - 1 + j
  int levels_ = 0;           ///< inner levels; the leaves stand on level levels_
};

}  // namespace oraclegs
