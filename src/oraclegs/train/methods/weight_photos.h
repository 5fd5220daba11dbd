#pragma once
// The weights of CoMapGS [Jang 2025] (train/baselines/covisibility.h) as weights of the photos' pixels.

#include <vector>

#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// The photos, the confidence of each pixel times its CovisibilityWeights, in units of their mean. L1, 1 - SSIM and the
/// loss of alpha weigh the pixel by it; masked pixels stay masked.
///
/// The paper's weights are in (0, 1]. Here one factor for all photos makes their mean 1 over the pixels that count, so
/// that a weight may exceed 1: photos keep their share of the loss beside depth and regularizers, and the screen
/// gradients that --densify adaptive compares with a threshold keep their size. Between the pixels of one photo and
/// between photos the ratios are the paper's. A pixel without known depth (depth_mask at most 0.5) counts as seen by
/// this photo alone, as one without a match does in the paper. One where nothing is known to be, of which the paper has
/// none, has the mean weight.
///
/// Throws UsageError where no photo has depth, and what CheckViews throws. The same for any number of threads. The
/// tensors of `photos` are not written.
std::vector<TrainView> WeightByCovisibility(std::vector<TrainView> photos);

}  // namespace oraclegs
