#include "oraclegs/gaussians/cuda/neighbors.h"

#include <limits>

#include "oraclegs/core/cuda/sort_scan.h"
#include "oraclegs/core/error.h"
#include "oraclegs/gaussians/cuda/neighbor_tree.h"

namespace oraclegs::cuda {
namespace {

constexpr const char* kPurpose = "the neighbors of the points to start from";
constexpr int kWholeKey = 32;  // bits

/// The tree's memory, and that of sorting it.
class TreeBuilder {
 public:
  explicit TreeBuilder(const std::vector<Eigen::Vector3f>& points) : n_(static_cast<int64_t>(points.size())) {
    points_.ReserveExactly(3 * n_);
    points_.Upload(points.data()->data(), 3 * n_);
    for (DeviceArray<uint32_t>* array : {&order_, &sorted_, &keys_, &sorted_keys_, &nodes_}) array->ReserveExactly(n_);
    boxes_.ReserveExactly(TreeNodes(n_));
  }

  /// Level by level from the root: sorts each node's points along its longest side, which cuts them into the next
  /// level's nodes. All nodes are sorted at once: by coordinate, then, leaving equals in their order, by node.
  NeighborTree Build() {
    RunStartTree(Tree(), nullptr);
    const int levels = TreeLevels(n_);
    for (int level = 0; level < levels; ++level) {
      RunNodeBoxes(Tree(), level, nullptr);
      RunSplitKeys(Tree(), level, keys_.data(), nodes_.data(), nullptr);
      SortOrder(kWholeKey);
      if (level == 0) continue;  // one node
      RunNodeKeys(nodes_.data(), order_.data(), n_, keys_.data(), nullptr);
      SortOrder(level);
    }
    RunNodeBoxes(Tree(), levels, nullptr);
    return Tree();
  }

 private:
  NeighborTree Tree() { return {points_.data(), n_, TreeLevels(n_), order_.data(), boxes_.data()}; }

  void SortOrder(int bits) {
    SortByKey({keys_.data(), order_.data(), sorted_keys_.data(), sorted_.data(), n_}, bits, &scratch_, nullptr);
    swap(order_, sorted_);
  }

  int64_t n_;
  DeviceArray<float> points_{kPurpose};
  DeviceArray<uint32_t> order_{kPurpose}, sorted_{kPurpose}, keys_{kPurpose}, sorted_keys_{kPurpose}, nodes_{kPurpose};
  DeviceArray<NodeBox> boxes_{kPurpose};
  Scratch scratch_{kPurpose};
};

}  // namespace

std::vector<double> MeanSquaredDistanceToThree(const std::vector<Eigen::Vector3f>& points) {
  if (points.size() > static_cast<size_t>(std::numeric_limits<int32_t>::max())) {
    throw ShapeError("MeanSquaredDistanceToThree: {} points, at most 2^31 - 1", points.size());
  }
  std::vector<double> means(points.size(), 0.0);
  if (points.size() < 2) return means;
  TreeBuilder builder(points);
  DeviceArray<double> distances(kPurpose);
  distances.ReserveExactly(static_cast<int64_t>(points.size()));
  RunNearestThree(builder.Build(), distances.data(), nullptr);
  distances.Download(static_cast<int64_t>(points.size()), means.data());
  return means;
}

}  // namespace oraclegs::cuda
