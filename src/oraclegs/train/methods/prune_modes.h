#pragma once
// The schedule of SparseGS floater pruning [Xiong 2023] (train/baselines/mode_floaters.h).

#include <vector>

#include "oraclegs/train/baselines/mode_floaters.h"
#include "oraclegs/train/trainer.h"

namespace oraclegs {

/// Opacity logit of removed Gaussians: below what any render shows, so that no gradient reaches them again.
inline constexpr float kRemovedLogit = -20;

/// Runs before the view of iteration --prune-modes-at: Gaussians that FindModeFloaters finds from the photos' cameras
/// get kRemovedLogit and opacity moments of 0. The next refinement removes them with --densify adaptive and relocates
/// them with --densify mcmc; without one, as in the published schedule, they stay in the model and are invisible.
class PruneModes final : public MethodPart {
 public:
  /// Throws UsageError where training ends before --prune-modes-at.
  explicit PruneModes(const TrainSetup& setup);

  /// Adds no gradient, returns 0.
  double BeforeView(const Iteration& iteration, TrainedModel* model, Gaussians* grads) override;
  bool AddsGradients() const override { return false; }

 private:
  TrainOptions options_;  // settled
  std::array<float, 3> background_;
  std::vector<Camera> cameras_;
};

}  // namespace oraclegs
