#pragma once
// What a published method does beside an iteration's view: other renders, other losses, removals. On the CPU only.

#include <memory>
#include <vector>

#include "oraclegs/train/train_device.h"

namespace oraclegs {

class MethodPart {
 public:
  virtual ~MethodPart() = default;

  /// Before the view of the iteration is rendered. Adds dL/d(raw parameters) of a loss of its own to `grads`, which the
  /// iteration's step takes with those of the view, and returns that loss. May also take steps of its own on `model`,
  /// but not change the number of its Gaussians. Renders with a rasteriser of its own.
  virtual double BeforeView(const Iteration& iteration, TrainedModel* model, Gaussians* grads) = 0;

  /// After clones and splits of an iteration that refines with --densify adaptive: keep[i] becomes false for those that
  /// are to be removed as well.
  virtual void Prune(const Iteration&, const Gaussians&, std::vector<bool>* /*keep*/) {}
};

using MethodParts = std::vector<std::shared_ptr<MethodPart>>;

}  // namespace oraclegs
