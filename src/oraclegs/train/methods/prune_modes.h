#pragma once
// When the floaters of SparseGS [Xiong 2023] (train/baselines/mode_floaters.h) are removed.

#include <vector>

#include "oraclegs/train/baselines/mode_floaters.h"
#include "oraclegs/train/trainer.h"

namespace oraclegs {

/// What is removed gets this opacity logit: below what any render shows, so that no gradient ever reaches it again.
inline constexpr float kRemovedLogit = -20;

/// Before the view of iteration --prune-modes-at: what FindModeFloaters finds with the cameras of the photos gets
/// kRemovedLogit and opacity moments of 0. The next refinement removes it with --densify adaptive and moves it
/// elsewhere with --densify mcmc; where there is none, as in the published schedule, it stays in the model and is
/// invisible.
class PruneModes final : public MethodPart {
 public:
  /// Throws UsageError where training ends before that iteration.
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
