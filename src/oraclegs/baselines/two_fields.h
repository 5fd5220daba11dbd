#pragma once
// Co-regularization of CoR-GS [Zhang 2024]: two models of one scene are trained on the same photos. Where they disagree
// they are likely wrong: Gaussians that only one has are removed (section 4.1), and renders of both from views where no
// photo was taken are pulled together (section 4.2). Order and constants are those of the authors' program.

#include <cstdint>
#include <memory>
#include <vector>

#include "oraclegs/baselines/baseline_setup.h"
#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// The public code prunes after every 500th iteration beyond the first 500: every 5th densification, as in the paper.
inline constexpr int64_t kCoPruneInterval = 500;

/// 1 for each Gaussian of `model` that has a center of `other` at most max_distance away, 0 for those to prune. Find
/// the masks of both models before pruning either. Exact; on all threads, the result is the same for any number.
/// Centers must be finite. Throws ShapeError for buffers that do not fit.
/// max_distance: world units; 5 in the paper; the public code takes 5 on LLFF, 10 on DTU and 20 on Mip-NeRF 360. It is
/// not scaled by the scene: poses in another unit need another number.
std::vector<uint8_t> CoPruneKeep(const Gaussians& model, const Gaussians& other, double max_distance);

/// Part that trains the second model beside the first one, whose setup this is: the same start, photos in the same
/// order before the same backgrounds, other random numbers. The second model steps in BeforeView of the first one's
/// part.
class TwoFields final : public MethodPart {
 public:
  /// Makes the second trainer, on the device of setup.make_device. Throws as Trainer.
  explicit TwoFields(const BaselineSetup& first);
  ~TwoFields() override;

  void Remove(const Iteration& iteration, TrainedModel* model) override;
  double BeforeView(const Iteration& iteration, TrainedModel* model, PartGradients* grads) override;
  void Attach(const TrainDevice& device) override;

  void Save(NamedState* state) const override;
  void Restore(const NamedState& state) override;

  /// The second model.
  const Gaussians& second() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace oraclegs
