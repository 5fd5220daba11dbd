#pragma once
// Depth that correlates with that of the photos: FSGS [Zhu 2024] (section 3.3) over the image, SparseGS [Xiong 2023]
// also over random patches. Inverse depths are compared (loss/depth_losses.h).

#include <vector>

#include "oraclegs/baselines/baseline_setup.h"
#include "oraclegs/render/image_buffer.h"

namespace oraclegs {

/// Adds depth_correlation * (1 - r) to the loss of each photo of known depth, where r is the correlation with the
/// rendered depth, and patched_correlation times its mean over random patches. After 95 % of the run the former is
/// multiplied by late_correlation. Has no state between iterations.
class CorrelatedDepth final : public MethodPart {
 public:
  /// Takes the depth of the photos. Throws the errors of CheckViews.
  explicit CorrelatedDepth(const BaselineSetup& setup);

  /// Throws Diverged where the loss is not finite.
  double OnView(const Iteration& iteration, const RenderOutput& out, RenderGrads* grads) override;

 private:
  BaselineSettings settings_;
  int64_t horizon_;                // iterations
  std::vector<TrainView> photos_;  // cameras and depth alone
  ImageBuffer gradient_, of_patches_;
};

}  // namespace oraclegs
