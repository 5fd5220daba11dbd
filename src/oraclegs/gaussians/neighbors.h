#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace oraclegs {

/// Another point near a point.
struct NearPoint {
  int64_t index = -1;  ///< -1: there is none
  double squared_distance = std::numeric_limits<double>::infinity();
};

/// Static k-d tree over points in space: a complete binary tree whose node ranges follow from the number of points
/// alone, so that it needs no links.
class KdTree {
 public:
  /// Builds on all threads. Coordinates must be finite.
  explicit KdTree(const std::vector<Eigen::Vector3f>& points);

  /// Mean squared distance of each point, in the order given to the constructor, to its three nearest others (to all
  /// others when there are fewer; 0 when there are none). Exact; a duplicate is at distance 0. On all threads.
  std::vector<double> MeanSquaredDistanceToThree() const;

  /// The three nearest other points of each point, in the order given to the constructor, the nearest first. Exact; of
  /// points at one distance any may come first, the same each time. On all threads.
  std::vector<std::array<NearPoint, 3>> ThreeNearest() const;

  /// Whether a point of the tree is at most `radius` away. The coordinates must be finite.
  bool HasWithin(const Eigen::Vector3f& query, double radius) const;

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
  struct MeanSearch;
  struct ThreeSearch;
  struct WithinSearch;

  Range RangeOf(int level, int64_t node) const;
  void Split(int level, int64_t node);
  template <class S>
  void Visit(int level, int64_t node, S* search) const;

  std::vector<Item> items_;
  std::vector<Node> nodes_;  ///< level by level: node j of level l at 2^l - 1 + j
  int levels_ = 0;           ///< inner levels; the leaves stand on level levels_
};

}  // namespace oraclegs
