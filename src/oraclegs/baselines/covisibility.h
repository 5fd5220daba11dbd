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

}  // namespace oraclegs
