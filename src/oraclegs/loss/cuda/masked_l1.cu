#include "oraclegs/loss/cuda/masked_l1.h"

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/core/cuda/sums-inl.cuh"

namespace oraclegs::cuda {
namespace {

__global__ void MaskedDistance(MaskedL1Input in) {
  __shared__ double sums[kSumWarps];
  const int thread = static_cast<int>(threadIdx.x);
  const int64_t begin = static_cast<int64_t>(blockIdx.x) * kMaskedL1PixelsABlock;
  double sum = 0;
  for (int k = thread; k < kMaskedL1PixelsABlock && begin + k < in.pixels; k += kSumThreads) {
    const int64_t i = begin + k;
    const float a = in.rendered[i], b = in.target.At(i), m = in.mask.is_there() ? in.mask.At(i) : 1.f;
    const float away = a - b;
    sum += static_cast<double>((away < 0 ? -away : away) * m);
    in.grad[i] = in.scale * (static_cast<float>(a > b) - static_cast<float>(a < b)) * m;
  }
  sum = BlockSum(sum, thread, sums);
  if (thread == 0) in.sums[blockIdx.x] = sum;
}

}  // namespace

void RunMaskedL1(const MaskedL1Input& in, cudaStream_t stream) {
  Launch("masked L1", MaskedDistance, {MaskedL1Blocks(in.pixels), kSumThreads}, stream, in);
}

}  // namespace oraclegs::cuda
