#pragma once
// What a published method does beside an iteration's view: other renders, other losses, removals. On the CPU only.

#include <memory>
#include <vector>

#include "oraclegs/train/checkpoint.h"
#include "oraclegs/train/train_device.h"

namespace oraclegs {

class MethodPart {
 public:
  virtual ~MethodPart() = default;

  /// Before everything else of an iteration: may remove Gaussians with their moments (KeepRows). What densification
  /// goes by begins anew where it does.
  virtual void Remove(const Iteration&, TrainedModel*) {}

  /// Before the view of the iteration is rendered. Adds dL/d(raw parameters) of a loss of its own to `grads`, which the
  /// iteration's step takes with those of the view, and returns that loss. May also take steps of its own on `model`,
  /// but not change the number of its Gaussians. Renders with a rasterizer of its own. `grads` has no Gaussians where
  /// AddsGradients of all parts is false.
  virtual double BeforeView(const Iteration& iteration, TrainedModel* model, Gaussians* grads) = 0;

  /// Whether BeforeView writes to `grads`.
  virtual bool AddsGradients() const { return true; }

  /// The state of a model of its own after an iteration; null where it has none.
  virtual std::shared_ptr<const Checkpoint> Save() const { return {}; }
  /// Goes on from there; null = from a checkpoint that holds none. Throws InputError where that does not fit.
  virtual void Restore(const Checkpoint*) {}
};

using MethodParts = std::vector<std::shared_ptr<MethodPart>>;

}  // namespace oraclegs
