#pragma once
// Modes of SparseGS [Xiong 2023]: for each pixel the Gaussian of the largest blending weight and those before it.

#include <cstdint>
#include <memory>
#include <vector>

#include "oraclegs/render/render.h"

namespace oraclegs {

/// Modes of one view, [H*W] each. A pixel that no Gaussian reaches has depths 0 and no entries.
struct RayModes {
  std::vector<float> mode_depth;     ///< z of the Gaussian of the largest blending weight, world units
  std::vector<float> blended_depth;  ///< z blended by weights, over the sum of the weights, world units
  /// Positions, in the list of the pixel's tile, of the first contributing Gaussian and of the mode; -1 for none.
  std::vector<int64_t> first_entry, mode_entry;
};

/// A view's Gaussians by tiles, near to far, as in the rasterizer.
class RayView {
 public:
  /// Throws ShapeError for buffers that do not fit or lie on a GPU.
  RayView(const Gaussians& gaussians, const Camera& camera, const RenderOptions& options);
  ~RayView();
  RayView(const RayView&) = delete;
  RayView& operator=(const RayView&) = delete;

  /// Blends every pixel (docs/method.md#blending). On all threads, the result is the same for any number.
  RayModes FindModes() const;

  /// Marks the Gaussians from the pixel's first to its mode whose falloff at the pixel's center, without the opacity,
  /// exceeds exp(min_log_falloff).
  void MarkUpToMode(const RayModes& modes, int64_t pixel, double min_log_falloff, std::vector<uint8_t>* marked) const;

 private:
  struct Lists;
  std::unique_ptr<Lists> lists_;
};

}  // namespace oraclegs
