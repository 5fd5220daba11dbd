#pragma once
// The loss of an iteration, added up where its parts are: the host asks for it only when it wants to show it.

#include <cuda_runtime.h>

#include <cstdint>

namespace oraclegs::cuda {

/// weight * (values[0] + values[stride] + ...), `count` numbers of the device's.
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
  double constant = 0;  ///< what the host knows already

  /// At most kMaxLossSums of them.
  void Add(const LossSum& sum) { sums[count++] = sum; }
};

struct LossAccumulator {
  double last = 0, smoothed = 0;
  int64_t nonfinite_iteration = 0;  ///< the first one whose loss was not finite; 0 = none
  double nonfinite_loss = 0;        ///< what it was
};

struct LossAccumulatorInput {
  LossSums loss;
  int64_t iteration = 0;
  double smoothing = 0;                    ///< share of the past in `smoothed`
  LossAccumulator* accumulator = nullptr;  ///< the device's
};

/// Queues the addition, and the smoothing: smoothed = smoothing * smoothed + (1 - smoothing) * last, from iteration 2.
void RunAccumulateLoss(const LossAccumulatorInput& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
