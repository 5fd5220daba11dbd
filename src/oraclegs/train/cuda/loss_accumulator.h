#pragma once
// The loss of an iteration, added up on the device: the host reads it only to show it.

#include <cuda_runtime.h>

#include <cstdint>

namespace oraclegs::cuda {

/// weight * (values[0] + values[stride] + ...), `count` numbers in device memory.
struct LossSum {
  const double* values = nullptr;
  int64_t count = 0;
  int64_t stride = 1;
  double weight = 0;
};

inline constexpr int kMaxLossSums = 7;

struct LossSums {
  LossSum sums[kMaxLossSums];
  int count = 0;
  double constant = 0;  ///< part of the loss that the host computed

  /// Appends a sum; at most kMaxLossSums.
  void Add(const LossSum& sum) { sums[count++] = sum; }
};

struct LossAccumulator {
  double last = 0, smoothed = 0;
  int64_t nonfinite_iteration = 0;  ///< the first iteration whose loss was not finite; 0 = none
  double nonfinite_loss = 0;        ///< loss of that iteration
};

struct LossAccumulatorInput {
  LossSums loss;
  int64_t iteration = 0;
  double smoothing = 0;                    ///< share of the past in `smoothed`
  LossAccumulator* accumulator = nullptr;  ///< in device memory
};

/// Queues the addition and the smoothing: smoothed = smoothing * smoothed + (1 - smoothing) * last, from iteration 2
/// on.
void RunAccumulateLoss(const LossAccumulatorInput& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
