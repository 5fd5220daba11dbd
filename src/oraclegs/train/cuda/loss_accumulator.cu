#include "oraclegs/train/cuda/loss_accumulator.h"

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/core/cuda/sums-inl.cuh"

namespace oraclegs::cuda {
namespace {

/// Adds up the loss, in one block.
__global__ void AccumulateLoss(LossAccumulatorInput in) {
  __shared__ double shared[kSumWarps];
  const int thread = static_cast<int>(threadIdx.x);
  double loss = in.loss.constant;
  for (int k = 0; k < in.loss.count; ++k) {
    const LossSum part = in.loss.sums[k];
    double sum = 0;
    for (int64_t i = thread; i < part.count; i += kSumThreads) sum += part.values[i * part.stride];
    loss += part.weight * BlockSum(sum, thread, shared);
  }
  if (thread != 0) return;
  LossAccumulator* to = in.accumulator;
  to->last = loss;
  to->smoothed = in.iteration == 1 ? loss : in.smoothing * to->smoothed + (1 - in.smoothing) * loss;
  const bool finite = loss - loss == 0;  // infinity and what is not a number leave something else
  if (finite || to->nonfinite_iteration != 0) return;
  to->nonfinite_iteration = in.iteration;
  to->nonfinite_loss = loss;
}

}  // namespace

void RunAccumulateLoss(const LossAccumulatorInput& in, cudaStream_t stream) {
  Launch("the sum of the loss", AccumulateLoss, {1, kSumThreads}, stream, in);
}

}  // namespace oraclegs::cuda
