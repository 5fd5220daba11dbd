#pragma once
// The schedule of SparseGS floater pruning [Xiong 2023] (baselines/mode_floaters.h).

#include <vector>

#include "oraclegs/baselines/baseline_setup.h"
#include "oraclegs/baselines/mode_floaters.h"

namespace oraclegs {

/// Opacity logit of removed Gaussians: below what any render shows, so that no gradient reaches them again.
inline constexpr float kRemovedLogit = -20;

/// Runs before the view of iteration prune_modes_at: Gaussians that FindModeFloaters finds from the photos' cameras
/// get kRemovedLogit and opacity moments of 0. The next refinement removes them with adaptive density control and
/// relocates them with 3DGS-MCMC; without one, as in the published schedule, they stay in the model and are invisible.
class PruneModes final : public MethodPart {
 public:
  explicit PruneModes(const BaselineSetup& setup);

  /// Adds no gradient, returns 0.
  double BeforeView(const Iteration& iteration, TrainedModel* model, PartGradients* grads) override;

 private:
  int at_;
  bool antialiased_;
  std::array<float, 3> background_;
  std::vector<Camera> cameras_;
};

}  // namespace oraclegs
