#pragma once
// The terms of an iteration's loss, evaluated on the CPU.

#include <optional>

#include "oraclegs/render/image_buffer.h"
#include "oraclegs/render/render.h"
#include "oraclegs/train/exposure.h"
#include "oraclegs/train/loss_terms.h"

namespace oraclegs {

struct ViewLossResult {
  double loss = 0;
  PhotometricValue photometric;
  double depth = 0, alpha = 0;  ///< the depth and alpha terms, with their weights
  RenderGrads grads;            ///< valid until the next view's
};

/// The loss of a view, by the terms of a plan. Owns the exposure maps where they are trained.
class ViewLoss {
 public:
  /// `plan` outlives this.
  explicit ViewLoss(const LossPlan& plan);

  /// Returns the loss and its gradients. out: the render of plan.View(sampled). Throws
  /// RunError when the loss is not finite, before an exposure map is stepped. The last iteration steps no map. Depth
  /// and alpha of grads stay undefined, which the rasterizer takes for zero at no cost, where the loss has no such
  /// term.
  ViewLossResult operator()(const SampledView& sampled, int64_t iteration, const RenderOutput& out);

  /// The exposure maps; nullptr where they are not trained.
  Exposures* exposures() { return exposures_ ? &*exposures_ : nullptr; }
  const Exposures* exposures() const { return exposures_ ? &*exposures_ : nullptr; }

 private:
  struct Rendered;

  /// Valid until the plane of another view is asked for.
  Buffer<float> PlaneOf(const TrainView& view, ViewPlane plane);
  double Evaluate(const LossTerm& term, const Rendered& rendered, ViewLossResult* result);

  const LossPlan& plan_;
  PhotometricLoss photometric_;
  std::optional<Exposures> exposures_;
  ExposureGradient exposure_gradient_{};
  ImageBuffer grad_image_, grad_inv_depth_, grad_alpha_, exposed_image_;
  ImageBuffer image_, weights_;  ///< of a view that holds them as bytes
};

}  // namespace oraclegs
