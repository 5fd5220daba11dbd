#pragma once
// Densification on a CPU: how Gaussians are added, moved and removed. (A GPU has 3DGS-MCMC alone, train/cuda/refine.h.)
// make_densifier.h makes the one of --densify.

#include <memory>

#include "oraclegs/render/render.h"
#include "oraclegs/train/loss_terms.h"
#include "oraclegs/train/train_device.h"

namespace oraclegs {

class Densifier {
 public:
  virtual ~Densifier() = default;

  /// Whether positions get the noise of 3DGS-MCMC in every iteration.
  virtual bool AddsNoise() const = 0;

  /// Called after the step of an iteration that refines or resets opacities.
  virtual void Refine(const Iteration& iteration, TrainedModel* model) = 0;

  /// State carried from iteration to iteration, for checkpoints; empty where there is none.
  virtual ScreenGradients state() const { return {}; }
  /// Clears the state for a model of that many Gaussians.
  virtual void Begin(int64_t gaussians) = 0;
  /// Restores the state for a model of that many Gaussians. Throws InputError when the state is of another number, or
  /// empty where this densifier has one.
  virtual void Restore(const ScreenGradients& state, int64_t gaussians) = 0;
};

/// Inputs of a densifier, which outlive it.
struct DensifierSetup {
  const TrainOptions& options;  ///< settled
  const LossPlan& plan;
  Rasterizer* rasterizer;
};

}  // namespace oraclegs
