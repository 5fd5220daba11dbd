#pragma once
// Densification: how Gaussians are added, moved and removed. 3DGS-MCMC's is mcmc.h's on a CPU and cuda/cuda_mcmc.h's
// on a GPU; others come with TrainSetup and run on both. Iterations count from 1.

#include <functional>
#include <memory>

#include "oraclegs/render/render.h"
#include "oraclegs/train/checkpoint.h"
#include "oraclegs/train/loss_terms.h"
#include "oraclegs/train/options.h"

namespace oraclegs {

struct Iteration;     // train/train_device.h
struct TrainedModel;  // train/train_device.h

class Densifier {
 public:
  virtual ~Densifier() = default;

  /// Whether positions get the noise of 3DGS-MCMC in every iteration. Without it an iteration that refines takes no
  /// step, as in programs with adaptive density control, whose new parameters have no gradient yet.
  virtual bool AddsNoise() const { return false; }

  /// Whether Refine is called after the step of this iteration: by default where the schedule refines.
  virtual bool Acts(const Iteration& iteration) const;

  /// Changes the model, which lies on the device of the training; OnHost (train/train_device.h) gives it on the host.
  virtual void Refine(const Iteration& iteration, TrainedModel* model) = 0;

  /// Clears the state carried from iteration to iteration, for a model of that many Gaussians.
  virtual void Begin(int64_t /*gaussians*/) {}
  /// Adds that state, under names of its own.
  virtual void Save(NamedState*) const {}
  /// Restores it for a model of that many Gaussians. Throws InputError where it is missing or of another number.
  virtual void Restore(const NamedState&, int64_t /*gaussians*/) {}
};

/// Inputs of a densifier, which outlive it.
struct DensifierSetup {
  const TrainOptions& options;
  const LossPlan& plan;
  Rasterizer* rasterizer;
  Device device = kCpu;
};
using DensifierMaker = std::function<std::unique_ptr<Densifier>(const DensifierSetup& setup)>;

}  // namespace oraclegs
