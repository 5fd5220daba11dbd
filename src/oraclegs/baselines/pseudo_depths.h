#pragma once
// Pseudo-view depth of FSGS [Zhu 2024] (section 3.3): renders from places between the photos should have the depth that
// a network sees in them. Order and constants are those of the authors' program, except for the views
// (baselines/pseudo_views.h) and for comparing inverse depths (loss/depth_losses.h).

#include <memory>
#include <vector>

#include "oraclegs/baselines/baseline_setup.h"
#include "oraclegs/render/image_buffer.h"

namespace oraclegs {

/// Iterations over which the weight grows from 0 to pseudo_depth_weight.
inline constexpr int kPseudoDepthRamp = 500;
/// The last iteration that uses a pseudo view, as a fraction of the run's: 9500 of 10000.
inline constexpr double kPseudoDepthEnd = 0.95;

/// Runs in every pseudo_depth_every-th iteration after pseudo_depth_start. Adds the gradient of weight * min(1,
/// (iteration - start) / kPseudoDepthRamp) * (1 - r), where r is the correlation of the rendered depth with that of
/// BaselineSetup::pseudo_depth. Where that depth depends on the render, as a network's does, colors get a gradient,
/// too. Has no state between iterations.
class PseudoDepths final : public MethodPart {
 public:
  /// Throws UsageError where the setup has no pseudo depth.
  explicit PseudoDepths(const BaselineSetup& setup);

  void Attach(const TrainDevice& device) override { rasterizer_ = device.NewRasterizer(); }
  double BeforeView(const Iteration& iteration, TrainedModel* model, PartGradients* grads) override;

 private:
  bool IsDue(const Iteration& iteration) const;

  TrainOptions options_;
  BaselineSettings settings_;
  uint64_t seed_;
  std::array<float, 3> background_;
  PseudoDepth depth_;
  std::vector<Camera> views_;
  std::unique_ptr<Rasterizer> rasterizer_;
  ImageBuffer of_rendered_, of_target_;  // dL/d(inverse depth)
  Gaussians grads_;
};

}  // namespace oraclegs
