#pragma once
// Sums of numbers of a view's pixels over the Gaussians that they show.

#include <memory>

#include "oraclegs/camera/camera.h"
#include "oraclegs/core/buffer.h"
#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/render/render.h"

namespace oraclegs {

/// Sums over a view's pixels of each Gaussian's blending weight times numbers of the pixel. They are gradients: with
/// one color for all Gaussians, dL/d(color) of one is the sum of its blending weights times dL/d(pixel).
class BlendedSums {
 public:
  /// Sums for these Gaussians, on their device; `options` gives the antialiasing.
  BlendedSums(const Gaussians& gaussians, const RenderOptions& options);

  /// Takes a view of three numbers a pixel, [H,W,3] on the host, in place of the last one. Throws ShapeError for
  /// another size than the camera's.
  void Take(const Camera& camera, const Buffer<float>& numbers);

  /// Sum of number `k` of the last view's pixels over Gaussian `i`.
  double Of(int64_t i, int k) const;

 private:
  std::unique_ptr<Rasterizer> rasterizer_;
  Gaussians gray_, grads_;
  Buffer<float> sh_;  // of grads_, on the host
  RenderOptions options_;
};

}  // namespace oraclegs
