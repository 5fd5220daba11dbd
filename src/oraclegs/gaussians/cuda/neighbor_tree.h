#pragma once
// The k-d tree of gaussians/neighbors.h on a GPU: node j of level l holds the items n j >> l ... n (j + 1) >> l,
// whatever the points are, so that neither duplicates nor a point far away make a node larger than others. Here a node
// also has the box of its points.

#include <cuda_runtime.h>

#include <cstdint>

namespace oraclegs::cuda {

inline constexpr int64_t kLeafPoints = 12;  ///< at most

/// Inner levels of a tree over n points; its leaves stand on the level below.
inline int TreeLevels(int64_t n) {
  int levels = 0;
  while ((n >> levels) > kLeafPoints) ++levels;
  return levels;
}
inline int64_t TreeNodes(int64_t n) { return (int64_t{2} << TreeLevels(n)) - 1; }

/// The six sides as whole numbers that grow outwards, 0 = no point yet.
struct NodeBox {
  uint32_t below[3], above[3];
};

/// All memory is the device's; n < 2^31.
struct NeighborTree {
  const float* points = nullptr;  ///< [n,3], finite
  int64_t n = 0;
  int levels = 0;             ///< TreeLevels(n)
  uint32_t* order = nullptr;  ///< [n] points, node by node
  NodeBox* boxes = nullptr;   ///< [TreeNodes(n)], level by level: node j of level l at 2^l - 1 + j
};

/// order = 0, 1, ... and no box has a point.
void RunStartTree(const NeighborTree& tree, cudaStream_t stream);

/// Once the order is that of the level's nodes: their boxes.
void RunNodeBoxes(const NeighborTree& tree, int level, cudaStream_t stream);

/// Writes the keys that the level's points are to be sorted by: keys [n], in the tree's order, their coordinates along
/// the longest side of their node's box; nodes [n], by point, the number of that node.
void RunSplitKeys(const NeighborTree& tree, int level, uint32_t* keys, uint32_t* nodes, cudaStream_t stream);

/// keys[i] = nodes[order[i]].
void RunNodeKeys(const uint32_t* nodes, const uint32_t* order, int64_t n, uint32_t* keys, cudaStream_t stream);

/// means [n], by point: the mean squared distance to the three nearest others, to all others when there are fewer. At
/// least two points.
void RunNearestThree(const NeighborTree& tree, double* means, cudaStream_t stream);

}  // namespace oraclegs::cuda
