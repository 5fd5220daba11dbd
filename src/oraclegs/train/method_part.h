#pragma once
// Work that a method does beside an iteration's view: other renders, other losses, removals. The parts of published
// methods: baselines/methods.h.

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "oraclegs/train/checkpoint.h"
#include "oraclegs/train/densify.h"
#include "oraclegs/train/train_device.h"

namespace oraclegs {

/// Gradients of parts, dL/d(raw parameters) on the device of the training, which an iteration's step takes together
/// with those of its view. They are valid until the step.
using PartGradients = std::vector<const Gaussians*>;

/// A part of the training. Models, renders and their gradients lie on the device of the training; OnHost, KeepRows
/// (train/train_device.h) and Buffer::To bring them to the host and back.
class MethodPart {
 public:
  virtual ~MethodPart() = default;

  /// Called once before the training, with its device.
  virtual void Attach(const TrainDevice&) {}

  /// Called first in an iteration. May remove Gaussians with their moments (KeepRows); the densifier's state is then
  /// cleared.
  virtual void Remove(const Iteration&, TrainedModel*) {}

  /// Called before the view of the iteration is rendered. May add gradients of a loss of its own, which it returns. May
  /// step `model` itself, but not change the number of its Gaussians. Renders with a rasterizer of its own.
  virtual double BeforeView(const Iteration&, TrainedModel*, PartGradients*) { return 0; }

  /// The color behind a photo's render; nullopt = the run's.
  virtual std::optional<std::array<float, 3>> Background(const Iteration&, const TrainView&) const { return {}; }

  /// Called with the render of the iteration's view, after the loss on it. May add to `grads`, where an undefined
  /// buffer stands for zeros, the gradient of a loss on that render, which it returns.
  virtual double OnView(const Iteration&, const RenderOutput&, RenderGrads*) { return 0; }

  /// Adds the part's state after an iteration, under names of its own.
  virtual void Save(NamedState*) const {}
  /// Restores what Save added. Throws InputError where it is missing or does not fit.
  virtual void Restore(const NamedState&) {}
};

using MethodParts = std::vector<std::shared_ptr<MethodPart>>;

/// Runs what parts do before an iteration's view: Remove, after which the densifier begins anew where Gaussians went,
/// and BeforeView. Returns the sum of their losses.
inline double RunParts(const MethodParts& parts, const Iteration& iteration, Densifier* densifier, TrainedModel* model,
                       PartGradients* gradients) {
  const int64_t before = model->gaussians.size();
  for (const std::shared_ptr<MethodPart>& part : parts) part->Remove(iteration, model);
  if (model->gaussians.size() != before) densifier->Begin(model->gaussians.size());
  double loss = 0;
  for (const std::shared_ptr<MethodPart>& part : parts) loss += part->BeforeView(iteration, model, gradients);
  return loss;
}

}  // namespace oraclegs
