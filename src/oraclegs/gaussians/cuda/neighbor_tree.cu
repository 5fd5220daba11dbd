#include "oraclegs/gaussians/cuda/neighbor_tree.h"

#include <cmath>

#include "oraclegs/core/cuda/launch.h"

namespace oraclegs::cuda {
namespace {

constexpr int kBlock = 256;
constexpr int kDeepest = 32;  // nodes that wait for a visit: one a level and one more

/// Whole numbers in the order of the floats.
__device__ uint32_t Ordered(float x) {
  const uint32_t bits = __float_as_uint(x);
  return bits ^ (bits >> 31 != 0 ? 0xffffffffu : 0x80000000u);
}
__device__ float FromOrdered(uint32_t key) {
  return __uint_as_float(key ^ (key >> 31 != 0 ? 0x80000000u : 0xffffffffu));
}
__device__ double Below(const NodeBox& box, int axis) { return static_cast<double>(FromOrdered(~box.below[axis])); }
__device__ double Above(const NodeBox& box, int axis) { return static_cast<double>(FromOrdered(box.above[axis])); }

/// Number of the node, within its level, of the item on this place.
__device__ int64_t NodeOf(const NeighborTree& tree, int level, int64_t place) {
  return (((place + 1) << level) - 1) / tree.n;
}
__device__ NodeBox* BoxOf(const NeighborTree& tree, int level, int64_t node) {
  return tree.boxes + ((int64_t{1} << level) - 1 + node);
}

__global__ void StartTree(NeighborTree tree) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kBlock + threadIdx.x;
  if (i < tree.n) tree.order[i] = static_cast<uint32_t>(i);
}

/// Largest value of the warp's lanes, in each of them. (Turing has no instruction for it.)
__device__ uint32_t WarpMax(uint32_t value) {
  for (int lanes = kWarp / 2; lanes > 0; lanes /= 2) value = max(value, __shfl_xor_sync(kAllLanes, value, lanes));
  return value;
}

/// The largest of whole numbers is the same in any order. A warp within one node asks for each side once.
__global__ void NodeBoxes(NeighborTree tree, int level) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kBlock + threadIdx.x;
  const bool has_point = i < tree.n;
  const int64_t place = has_point ? i : tree.n - 1;
  const int node = static_cast<int>(NodeOf(tree, level, place));
  const float* point = tree.points + 3 * static_cast<int64_t>(tree.order[place]);
  NodeBox* box = BoxOf(tree, level, node);
  const bool alone = __shfl_sync(kAllLanes, node, 0) == __shfl_sync(kAllLanes, node, kWarp - 1);
  for (int axis = 0; axis < 3; ++axis) {
    uint32_t above = Ordered(point[axis]), below = ~above;
    if (alone) {
      above = WarpMax(above);
      below = WarpMax(below);
    }
    if (alone ? threadIdx.x % kWarp == 0 : has_point) {
      atomicMax(box->above + axis, above);
      atomicMax(box->below + axis, below);
    }
  }
}

__global__ void SplitKeys(NeighborTree tree, int level, uint32_t* keys, uint32_t* nodes) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kBlock + threadIdx.x;
  if (i >= tree.n) return;
  const int64_t node = NodeOf(tree, level, i);
  const NodeBox& box = *BoxOf(tree, level, node);
  int longest = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (Above(box, axis) - Below(box, axis) > Above(box, longest) - Below(box, longest)) longest = axis;
  }
  const uint32_t point = tree.order[i];
  keys[i] = Ordered(tree.points[3 * static_cast<int64_t>(point) + longest]);
  nodes[point] = static_cast<uint32_t>(node);
}

__global__ void NodeKeys(const uint32_t* nodes, const uint32_t* order, int64_t n, uint32_t* keys) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kBlock + threadIdx.x;
  if (i < n) keys[i] = nodes[order[i]];
}

/// Sum of squares, in equal steps for the bound of a box and for a distance, none of which gives less for more:
/// rounding never makes the bound exceed a distance.
__device__ double SquaredLength(double x, double y, double z) { return std::fma(z, z, std::fma(y, y, x * x)); }

struct Search {
  double query[3];
  double nearest[3];  ///< squared, ascending

  __device__ void Offer(double d2) {
    if (d2 >= nearest[2]) return;
    const double first = nearest[0], second = nearest[1];
    nearest[2] = d2 < second ? second : d2;
    nearest[1] = d2 < first ? first : (d2 < second ? d2 : second);
    nearest[0] = d2 < first ? d2 : first;
  }
  __device__ double DistanceTo(const float* point) const {
    return SquaredLength(static_cast<double>(point[0]) - query[0], static_cast<double>(point[1]) - query[1],
                         static_cast<double>(point[2]) - query[2]);
  }
  __device__ double Outside(const NodeBox& box, int axis) const {
    const double below = Below(box, axis) - query[axis], above = query[axis] - Above(box, axis);
    return below > 0 ? below : above > 0 ? above : 0;
  }
  __device__ double DistanceTo(const NodeBox& box) const {
    return SquaredLength(Outside(box, 0), Outside(box, 1), Outside(box, 2));
  }
};

__device__ void ScanLeaf(const NeighborTree& tree, int64_t leaf, int64_t self, Search* search) {
  const int64_t end = tree.n * (leaf + 1) >> tree.levels;
  for (int64_t i = tree.n * leaf >> tree.levels; i < end; ++i) {
    if (i != self) search->Offer(search->DistanceTo(tree.points + 3 * static_cast<int64_t>(tree.order[i])));
  }
}

/// A thread a point, in the tree's order: neighbors in a warp visit the same nodes. Nodes are numbered from the root,
/// 1, so that those below k are 2k and 2k + 1.
__global__ void NearestThree(NeighborTree tree, double* means) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kBlock + threadIdx.x;
  if (i >= tree.n) return;
  const int64_t self = tree.order[i];
  Search search;
  for (int axis = 0; axis < 3; ++axis) {
    search.query[axis] = static_cast<double>(tree.points[3 * self + axis]);
    search.nearest[axis] = HUGE_VAL;
  }
  uint32_t waiting[kDeepest];
  double distance[kDeepest];
  int count = 1;
  waiting[0] = 1, distance[0] = 0;
  while (count > 0) {
    --count;
    if (!(distance[count] < search.nearest[2])) continue;
    const uint32_t node = waiting[count];
    if (node >> tree.levels != 0) {
      ScanLeaf(tree, static_cast<int64_t>(node) - (int64_t{1} << tree.levels), i, &search);
      continue;
    }
    const double left = search.DistanceTo(tree.boxes[2 * node - 1]), right = search.DistanceTo(tree.boxes[2 * node]);
    const bool right_first = right < left;
    waiting[count] = right_first ? 2 * node : 2 * node + 1;
    distance[count++] = right_first ? left : right;
    waiting[count] = right_first ? 2 * node + 1 : 2 * node;
    distance[count++] = right_first ? right : left;
  }
  const int others = tree.n > 3 ? 3 : static_cast<int>(tree.n) - 1;
  double sum = 0;
  for (int k = 0; k < others; ++k) sum += search.nearest[k];
  means[self] = sum / others;
}

}  // namespace

void RunStartTree(const NeighborTree& tree, cudaStream_t stream) {
  const size_t bytes = static_cast<size_t>(TreeNodes(tree.n)) * sizeof(NodeBox);
  Check(cudaMemsetAsync(tree.boxes, 0, bytes, stream), "starting the tree of neighbors");
  Launch("start of the tree of neighbors", StartTree, LaunchShape::For(tree.n, kBlock), stream, tree);
}

void RunNodeBoxes(const NeighborTree& tree, int level, cudaStream_t stream) {
  Launch("boxes of neighbors", NodeBoxes, LaunchShape::For(tree.n, kBlock), stream, tree, level);
}

void RunSplitKeys(const NeighborTree& tree, int level, uint32_t* keys, uint32_t* nodes, cudaStream_t stream) {
  Launch("splitting neighbors", SplitKeys, LaunchShape::For(tree.n, kBlock), stream, tree, level, keys, nodes);
}

void RunNodeKeys(const uint32_t* nodes, const uint32_t* order, int64_t n, uint32_t* keys, cudaStream_t stream) {
  Launch("gathering neighbors", NodeKeys, LaunchShape::For(n, kBlock), stream, nodes, order, n, keys);
}

void RunNearestThree(const NeighborTree& tree, double* means, cudaStream_t stream) {
  Launch("search of neighbors", NearestThree, LaunchShape::For(tree.n, kBlock), stream, tree, means);
}

}  // namespace oraclegs::cuda
