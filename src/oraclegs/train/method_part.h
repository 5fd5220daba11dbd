#pragma once
// Work that a published method does beside an iteration's view: other renders, other losses, removals. On the CPU only.

#include <memory>
#include <vector>

#include "oraclegs/train/checkpoint.h"
#include "oraclegs/train/train_device.h"

namespace oraclegs {

class MethodPart {
 public:
  virtual ~MethodPart() = default;

  /// Called first in an iteration. May remove Gaussians with their moments (KeepRows); the densifier's state is then
  /// cleared.
  virtual void Remove(const Iteration&, TrainedModel*) {}

  /// Called before the view of the iteration is rendered. Adds dL/d(raw parameters) of a loss of its own to `grads`,
  /// which the iteration's step takes together with those of the view, and returns that loss. May step `model` itself,
  /// but not change the number of its Gaussians. Renders with a rasterizer of its own. `grads` has no Gaussians where
  /// AddsGradients of all parts is false.
  virtual double BeforeView(const Iteration& iteration, TrainedModel* model, Gaussians* grads) = 0;

  /// Whether BeforeView writes to `grads`.
  virtual bool AddsGradients() const { return true; }

  /// Checkpoint of the part's own model after an iteration; null where it has none.
  virtual std::shared_ptr<const Checkpoint> Save() const { return {}; }
  /// Continues from a checkpoint; null = from one that holds none. Throws InputError where it does not fit.
  virtual void Restore(const Checkpoint*) {}
};

using MethodParts = std::vector<std::shared_ptr<MethodPart>>;

}  // namespace oraclegs
