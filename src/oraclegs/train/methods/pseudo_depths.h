#pragma once
// Pseudo-view depth of FSGS [Zhu 2024] (section 3.3): renders from places between the photos should have the depth that
// a network sees in them. Order and constants are those of the authors' program, except for the views
// (train/baselines/pseudo_views.h) and for comparing inverse depths (loss/pearson_depth.h).

#include <memory>
#include <vector>

#include "oraclegs/render/image_buffer.h"
#include "oraclegs/train/trainer.h"

namespace oraclegs {

/// Iterations over which the weight grows from 0 to --pseudo-depth-weight.
inline constexpr int kPseudoDepthRamp = 500;
/// The last iteration that uses a pseudo view, as a fraction of the run's: 9500 of 10000.
inline constexpr double kPseudoDepthEnd = 0.95;

/// Runs in every --pseudo-depth-every-th iteration after --pseudo-depth-start. Adds the gradient of weight * min(1,
/// (iteration - start) / kPseudoDepthRamp) * (1 - r), where r is the correlation of the rendered depth with that of
/// TrainSetup::pseudo_depth. Where that depth depends on the render, as a network's does, colors get a gradient, too.
/// Has no state between iterations.
class PseudoDepths final : public MethodPart {
 public:
  /// Throws UsageError where the setup has no pseudo depth.
  explicit PseudoDepths(const TrainSetup& setup);

  double BeforeView(const Iteration& iteration, TrainedModel* model, Gaussians* grads) override;

 private:
  bool IsDue(const Iteration& iteration) const;

  TrainOptions options_;  // settled
  uint64_t seed_;
  std::array<float, 3> background_;
  PseudoDepth depth_;
  std::vector<Camera> views_;
  std::unique_ptr<Rasterizer> rasterizer_;
  ImageBuffer of_rendered_, of_target_;  // dL/d(inverse depth)
  Gaussians grads_;
};

}  // namespace oraclegs
