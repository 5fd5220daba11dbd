#pragma once
// How sure a model is of what it shows (docs/method.md#uncertainty).

#include <memory>
#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/core/buffer.h"
#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/render/render.h"

namespace oraclegs {

/// Error in [0, 1] that has the last color of images of errors; larger ones have it, too.
inline constexpr float kLargestShownError = 0.3f;

/// The error to expect of a model's renders, from how far the renders of several models differ: it and those that
/// learned from the same photos in other ways. Where photos leave something open, each fills it in differently.
class Uncertainty {
 public:
  /// Uses `others`, models in the same coordinates and on the same device; where there are none, the model itself
  /// without a part of its Gaussians, the same in each run, stands in for two of them. `model` must outlive this. The
  /// background and the antialiasing of `options` hold for all.
  Uncertainty(const Gaussians& model, std::vector<Gaussians> others, const RenderOptions& options);

  /// The expected ColorError (image/color_error.h) of each pixel in [0, 1], row by row.
  std::vector<float> At(const Camera& camera);

  /// The expected error of each Gaussian, [N] in [0, 1]: the mean over the pixels of the views that
  /// show it, by its blending weights. One that no view shows is among the least certain: it has the value that 98 % of
  /// the others stay below.
  std::vector<float> OfGaussians(const std::vector<Camera>& views);

 private:
  struct Member {
    const Gaussians* gaussians;
    Buffer<float> factors;  // of opacities; undefined = 1
  };

  const Gaussians& model_;
  std::vector<Gaussians> others_;
  std::vector<Member> members_;
  RenderOptions options_;
  std::unique_ptr<Rasterizer> rasterizer_;
};

}  // namespace oraclegs
