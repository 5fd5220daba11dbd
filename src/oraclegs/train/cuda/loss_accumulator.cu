#include "oraclegs/train/cuda/loss_accumulator.h"

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/loss/cuda/sums-inl.cuh"

namespace oraclegs::cuda {
namespace {

/// One block.
__global__ void AddUpLoss(LossAccumulatorEntry entry) {
  __shared__ double shared[kSumThreads];
  const int thread = static_cast<int>(threadIdx.x);
  double loss = entry.loss.constant;
  for (int t = 0; t < entry.loss.count; ++t) {
    const LossTerm term = entry.loss.terms[t];
    double sum = 0;
    for (int64_t i = thread; i < term.count; i += kSumThreads) sum += term.values[i * term.stride];
    loss += term.weight * BlockSum(sum, thread, shared);
  }
  if (thread != 0) return;
  LossAccumulator* ledger = entry.ledger;
  ledger->last = loss;
  ledger->smoothed = entry.iteration == 1 ? loss : entry.smoothing * ledger->smoothed + (1 - entry.smoothing) * loss;
  const bool finite = loss - loss == 0;  // infinity and what is not a number leave something else
  if (finite || ledger->broken != 0) return;
  ledger->broken = entry.iteration;
  ledger->broken_loss = loss;
}

}  // namespace

void RunLedger(const LossAccumulatorEntry& entry, cudaStream_t stream) {
  Launch("the sum of the loss", AddUpLoss, {1, kSumThreads}, stream, entry);
}

}  // namespace oraclegs::cuda
