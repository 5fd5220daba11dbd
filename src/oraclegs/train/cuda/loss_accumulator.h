#pragma once
// The loss of an iteration, added up where its parts are: the host asks for it only when it wants to show it.

#include <cuda_runtime.h>

#include <cstdint>

namespace oraclegs::cuda {

/// weight * (values[0] + values[stride] + ...), `count` numbers of the device's.
struct LossTerm {
  const double* values = nullptr;
  int64_t count = 0;
  int64_t stride = 1;
  double weight = 0;
};

inline constexpr int kMaxLossTerms = 7;

struct LossTerms {
  LossTerm terms[kMaxLossTerms];
  int count = 0;
  double constant = 0;  ///< what the host knows already

  /// At most kMaxLossTerms of them.
  void Add(const LossTerm& term) { terms[count++] = term; }
};

struct LossAccumulator {
  double last = 0, smoothed = 0;
  int64_t broken = 0;      ///< the first iteration whose loss was not finite; 0 = none
  double broken_loss = 0;  ///< what it was
};

struct LossAccumulatorEntry {
  LossTerms loss;
  int64_t iteration = 0;
  double smoothing = 0;          ///< share of the past in `smoothed`
  LossAccumulator* ledger = nullptr;  ///< the device's
};

/// Queues the addition, and the smoothing: smoothed = smoothing * smoothed + (1 - smoothing) * last, from iteration 2.
void RunLedger(const LossAccumulatorEntry& entry, cudaStream_t stream);

}  // namespace oraclegs::cuda
