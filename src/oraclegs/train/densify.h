#pragma once
// How the number and the places of the Gaussians change on a CPU. (A GPU has 3DGS-MCMC alone, train/cuda/refine.h.)
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

  /// After the step of an iteration that refines or resets opacities.
  virtual void Refine(const Iteration& iteration, TrainedModel* model) = 0;

  /// What of earlier iterations the next refinement goes by; empty where that is nothing.
  virtual ScreenGradients state() const { return {}; }
  /// Begins anew, for a model of so many Gaussians.
  virtual void Begin(int64_t gaussians) = 0;
  /// Goes on from the state of a model of so many Gaussians. Throws InputError when it is of another number, or empty
  /// where this kind has one.
  virtual void Restore(const ScreenGradients& state, int64_t gaussians) = 0;
};

/// What a densifier works on, which outlives it.
struct DensifierSetup {
  const TrainOptions& options;  ///< settled
  const LossPlan& plan;
  Rasterizer* rasterizer;
};

}  // namespace oraclegs
