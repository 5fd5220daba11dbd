#pragma once
// Hard and soft depth of DNGaussian [Li 2024] (section 3.2): depth moves positions and opacities, each in a step of its
// own, and nothing else. Order and constants are those of the authors' program.
//
// The loss compares inverse depths, rendered and of the photo. A network's depth is an inverse depth up to a factor and
// an offset, which the normalization of the loss removes (loss/depth_losses.h); DNGaussian renders a depth and
// inverts the network's. Not implemented: its learning rate of positions, which begins to fall late, and its colors
// from a grid of features and a network.

#include <memory>

#include "oraclegs/baselines/baseline_setup.h"
#include "oraclegs/loss/depth_losses.h"

namespace oraclegs {

inline constexpr double kHardOpacity = 0.95;  ///< opacity of all Gaussians in the render of hard depth
/// Added to the run's seed, so that soft depth draws other patch sizes than hard depth.
inline constexpr uint64_t kSoftPatchSeed = 0xD1B54A32D192ED03;

/// The photos' cameras and clean depth, without images, confidence and alpha. Throws the errors of CheckViews.
std::vector<TrainView> DepthAlone(const std::vector<TrainView>& photos);

/// Runs before the view of every depth_step_every-th iteration that takes a photo of known depth, while densification
/// lasts and never in the last iteration:
/// - hard_depth: a render in which all Gaussians have kHardOpacity; a step of the positions alone;
/// - after iteration soft_depth_start: an ordinary render; a step of the opacities alone.
/// The loss is kLocalDepthWeight times the local plus kGlobalDepthWeight times the global NormalizedDepthLoss, over
/// patches whose sizes are drawn anew each time. Learning rates are the iteration's. Has no state between iterations.
class DepthSteps final : public MethodPart {
 public:
  /// Takes the photos with depth. Throws UsageError where there are none, and the errors of CheckViews.
  explicit DepthSteps(const BaselineSetup& setup);

  void Attach(const TrainDevice& device) override { rasterizer_ = device.NewRasterizer(); }

  /// Steps the model. Adds no gradients and returns 0. Throws Diverged where the depth loss is not finite.
  double BeforeView(const Iteration& iteration, TrainedModel* model, PartGradients* grads) override;

 private:
  bool IsDue(const Iteration& iteration) const;
  /// The gradient of the depth loss of a render of `gaussians` from the photo.
  const Gaussians& Gradient(const Gaussians& gaussians, const TrainView& photo, const Iteration& iteration,
                            uint64_t patch_seed);

  TrainOptions options_;
  BaselineSettings settings_;
  std::vector<TrainView> photos_;  // cameras and depth alone
  std::unique_ptr<Rasterizer> rasterizer_;
  Buffer<float> grad_inv_depth_;  // [H,W]
  Gaussians grads_;
};

}  // namespace oraclegs
