#pragma once
// Observers of a training.

#include <cstdint>
#include <functional>

#include "oraclegs/core/function_ref.h"
#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/train/term_sums.h"

namespace oraclegs {

/// The training between two iterations. Valid during the call that gets it.
struct TrainMoment {
  int64_t iteration = 0;       ///< finished iterations; 0 before the first
  int64_t total = 0;           ///< iterations of the whole training
  double seconds = 0;          ///< training time, summed over resumed runs
  const Gaussians& gaussians;  ///< on the device of the training; read-only
  /// The smoothed loss. Waits for the device, and throws RunError where training has diverged.
  FunctionRef<double()> loss;
  TermSums terms = {};  ///< sums over the iterations of this process
};

/// Called before the first iteration and after each. It cannot change the result, but its time is part of the
/// training's.
using TrainObserver = std::function<void(const TrainMoment&)>;

}  // namespace oraclegs
