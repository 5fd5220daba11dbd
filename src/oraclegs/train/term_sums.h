#pragma once
// Terms of the loss, summed over iterations, for observers.

#include <cstdint>

namespace oraclegs {

/// Sums since training began in this process. All 0 on a device that does not keep them.
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

}  // namespace oraclegs
