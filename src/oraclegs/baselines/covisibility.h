#pragma once
// Covisibility maps of CoMapGS [Jang 2025] (section 3.1, eq. 1) and its weights (section 3.3, eq. 10): surfaces that
// few views show get more weight.
//
// Two things differ from the paper. It counts the views in which a network finds a match of the pixel, and cleans the
// map with erosion and dilation; here a view counts where depth maps agree. And its weight is that of a loss of
// Gaussians, looked up where their centers project (their distance from a point cloud, by a classifier that is trained
// for it); the paper weights no image loss by pixels. CovisibilityWeights is the same number for each pixel, the
// closest thing for a loss that has pixels.

#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/core/buffer.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// A training view with depth.
struct CovisibilityView {
  Camera camera;
  Buffer<float> inv_depth;  ///< [H,W] 1/z, 1/world unit, 0 = nothing is there; undefined = unknown everywhere
  Buffer<float> mask;       ///< [H,W] in [0,1], the depth is known above 0.5; undefined = known everywhere
};

/// M of eq. 1 for views[index], [H,W], from 0 to the number of views less one: for each pixel, the number of other
/// views that see the same surface point. A view sees it when the point lies in its image, before the camera, and z
/// times its inverse depth at that pixel is 1 within `tolerance`. 0 where the view's own depth is unknown. On all
/// threads, the result is the same for any number. Throws ShapeError where buffers do not fit the camera or there is no
/// such view.
Buffer<float> CovisibilityMap(const std::vector<CovisibilityView>& views, size_t index, double tolerance = 0.05);

/// 1 / (M + 1) of each pixel, eq. 10: 1 where one view alone sees the point.
Buffer<float> CovisibilityWeights(const Buffer<float>& map);

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
