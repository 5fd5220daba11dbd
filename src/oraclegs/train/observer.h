#pragma once
// Who looks on while a model is trained.

#include <cstdint>
#include <functional>

#include "oraclegs/core/function_ref.h"
#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/train/term_sums.h"

namespace oraclegs {

/// The training between two iterations. Valid during the call that gets it.
struct TrainMoment {
  int64_t iteration = 0;       ///< finished ones; 0 before the first
  int64_t total = 0;           ///< iterations of the whole training
  double seconds = 0;          ///< of training, summed over resumed runs
  const Gaussians& gaussians;  ///< on the device of the training; only to be read
  /// Smoothed over the iterations. Waits for the device, and throws RunError where training has diverged.
  FunctionRef<double()> loss;
  TermSums terms = {};  ///< of the iterations of this process
};

/// Is called before the first iteration and after each. What it does is no part of the result, but its time is part of
/// the training's.
using TrainObserver = std::function<void(const TrainMoment&)>;

}  // namespace oraclegs
