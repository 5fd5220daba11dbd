#pragma once
// What the loss consisted of, summed over iterations: for those that look on.

#include <cstdint>

namespace oraclegs {

/// Sums since a training began in this process. All 0 on a device that does not keep them.
struct TermSums {
  int64_t photos = 0, proposals = 0;  ///< iterations that took a photo, a proposal
  double l1 = 0;                      ///< of photos: mean |render - image|, where the mask counts
  double dssim = 0;                   ///< of photos: mean 1 - SSIM, likewise
  double depth = 0, alpha = 0;        ///< of photos: these terms with their weights
  double proposal = 0;                ///< of proposals: their whole loss
  double regularization = 0;          ///< of all: opacities and scales, with their weights

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

}  // namespace oraclegs
