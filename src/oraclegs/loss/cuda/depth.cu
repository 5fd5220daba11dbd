#include "oraclegs/loss/cuda/depth.h"

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/loss/cuda/sums-inl.cuh"

namespace oraclegs::cuda {
namespace {

__global__ void MaskedDepthDistance(DepthInput in) {
  __shared__ double sums[kSumThreads];
  const int thread = static_cast<int>(threadIdx.x);
  const int64_t begin = static_cast<int64_t>(blockIdx.x) * kDepthPixelsABlock;
  double sum = 0;
  for (int k = thread; k < kDepthPixelsABlock && begin + k < in.pixels; k += kSumThreads) {
    const int64_t i = begin + k;
    const float a = in.inv_depth[i], b = in.target[i], m = in.mask.At(i);
    const float away = a - b;
    sum += static_cast<double>((away < 0 ? -away : away) * m);
    in.grad[i] = in.scale * (static_cast<float>(a > b) - static_cast<float>(a < b)) * m;
  }
  sum = BlockSum(sum, thread, sums);
  if (thread == 0) in.sums[blockIdx.x] = sum;
}

}  // namespace

void RunDepth(const DepthInput& in, cudaStream_t stream) {
  Launch("depth loss", MaskedDepthDistance, {DepthBlocks(in.pixels), kSumThreads}, stream, in);
}

}  // namespace oraclegs::cuda
