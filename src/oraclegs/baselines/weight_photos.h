#pragma once
// Covisibility weights of CoMapGS [Jang 2025] (baselines/covisibility.h) as pixel weights of the photos.

#include <vector>

#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// The photos, with each pixel's confidence multiplied by its CovisibilityWeights over their mean. L1, 1 - SSIM and the
/// loss of alpha use it as the pixel's weight; masked pixels stay masked.
///
/// The paper's weights are in (0, 1]. Here one factor for all photos makes their mean 1 over the unmasked pixels, so
/// that a weight may exceed 1: photos keep their share of the loss beside depth and regularizers, and the screen
/// gradients that adaptive density control compares with a threshold keep their size. Ratios between pixels, also of
/// different photos, are the paper's. A pixel without known depth (depth_mask at most 0.5) counts as seen by this photo
/// alone, like one without a match in the paper. A pixel known to be empty, a case that the paper does not have, has
/// the mean weight.
///
/// Throws UsageError where no photo has depth, and the errors of CheckViews. The result does not depend on the number
/// of threads. The tensors of `photos` are not written.
std::vector<TrainView> WeightByCovisibility(std::vector<TrainView> photos);

}  // namespace oraclegs
