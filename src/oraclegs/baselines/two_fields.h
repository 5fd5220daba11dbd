#pragma once
// Co-regularization of CoR-GS [Zhang 2024]: two models of one scene are trained on the same photos. Where they disagree
// they are likely wrong: Gaussians that only one has are removed (section 4.1), and renders of both from views where no
// photo was taken are pulled together (section 4.2). Order and constants are those of the authors' program.

#include <memory>

#include "oraclegs/baselines/baseline_setup.h"

namespace oraclegs {

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
