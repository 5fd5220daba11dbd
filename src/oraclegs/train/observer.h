#pragma once
// Observers of a training.

#include <cstdint>
#include <functional>

#include "oraclegs/core/function_ref.h"
#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// Terms of the loss, summed over the iterations since training began in this process. All 0 on a device that does not
/// keep them.
struct TermSums {
  int64_t photos = 0, proposals = 0;  ///< iterations that took a photo or a proposal
  double l1 = 0;                      ///< photos: mean |render - image| over the mask
  double dssim = 0;                   ///< photos: mean 1 - SSIM over the mask
  double depth = 0, alpha = 0;        ///< photos: the depth and alpha terms with their weights
  double proposal = 0;                ///< proposals: their whole loss
  double regularization = 0;          ///< all iterations: opacities and scales, with their weights

  TermSums Since(const TermSums& before) const {
    return {photos - before.photos,
            proposals - before.proposals,
            l1 - before.l1,
            dssim - before.dssim,
            depth - before.depth,
            alpha - before.alpha,
            proposal - before.proposal,
            regularization - before.regularization};
  }
};

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
