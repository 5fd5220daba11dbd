#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/render/render.h"
#include "oraclegs/train/checkpoint.h"
#include "oraclegs/train/method_part.h"
#include "oraclegs/train/observer.h"
#include "oraclegs/train/options.h"
#include "oraclegs/train/pseudo_depth.h"
#include "oraclegs/train/timings.h"
#include "oraclegs/train/train_device.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

struct TrainResult {
  int64_t iterations = 0;
  double seconds = 0;    ///< of training, summed over resumed runs
  int64_t steps = 0;     ///< iterations of this Run alone, 0 when a checkpoint of the last one was restored
  TrainTimings timings;  ///< means over `steps`
};

/// Where and how often to save. An empty folder saves nothing.
struct CheckpointPolicy {
  std::filesystem::path dir;
  int64_t every = 0;       ///< iterations; 0 = only on an interrupt
  nlohmann::json options;  ///< stored, compared on resume
};

/// What a run starts from.
struct TrainSetup {
  TrainOptions options;
  uint64_t seed = 0;
  std::array<float, 3> background{};
  TrainingData data;
  Gaussians start;                ///< on the CPU
  MethodParts parts = {};         ///< of other methods
  PseudoDepth pseudo_depth = {};  ///< of --pseudo-depth-weight
  /// Of the order of the views and of random backgrounds; `seed` unless given.
  std::optional<uint64_t> view_seed = {};
};

/// 3DGS-MCMC on photos, on proposals as often as the schedule says, and on depth where a view has it. One
/// iteration: learning rate, SH degree -> view -> render -> loss -> backward -> Adam step -> relocate, add -> noise.
/// Adam goes before relocation (the order of [Ye 2025], docs/method.md#one-iteration). The last iteration makes neither
/// a step nor noise. The loss is the view's (train/view_loss.h) and the regularizers.
class Trainer {
 public:
  /// On the CPU. Throws ShapeError / UsageError before any work.
  Trainer(const TrainOptions& options, uint64_t seed, std::array<float, 3> background, TrainingData data,
          Gaussians start);
  /// On the device that `make_device` makes; also throws RunError when its memory does not suffice.
  Trainer(TrainSetup setup, const TrainDeviceMaker& make_device);
  ~Trainer();

  /// Continues from here instead of from the start. Throws InputError when it does not fit, also when it is of another
  /// number of photos or proposals.
  void Restore(const Checkpoint& checkpoint);

  /// Runs the remaining iterations. Notes, once, when proposals are to be learned from without LPIPS. On an interrupt
  /// saves a checkpoint and throws Interrupted. Throws OutOfMemory when the device's memory ends on the way, and
  /// Diverged when a loss or a parameter is no number any more; both name the last checkpoint, which is whole.
  /// `observer` may be empty.
  TrainResult Run(const CheckpointPolicy& policy, const Listener& listener, const TrainObserver& observer = {});

  /// One iteration; returns the loss. For tests and benchmarks.
  double Step();

  /// Between iterations: keeps the Gaussians of these rows, with their moments. On the CPU only.
  void Keep(const std::vector<int64_t>& rows);

  /// On the device of the training.
  const Gaussians& gaussians() const;
  int64_t iteration() const;
  /// What turns a render into each photo's colors; empty unless the exposure is trained.
  std::vector<ExposureMap> exposures() const;
  /// Means over the iterations since the last Run or Restore began, or since construction; `total` is filled by Run.
  TrainTimings MeanTimings() const;
  /// Of the last iteration alone; without `total`. On a GPU waits for it, and `loss` and `refine` are what sending the
  /// work took; MeanTimings has only these and `total` there.
  TrainTimings LastTimings() const;
  RenderStats LastStats() const;
  Checkpoint MakeCheckpoint() const;

 private:
  struct State;
  TrainResult RunToTheEnd(const CheckpointPolicy& policy, const Listener& listener, const TrainObserver& observer);

  std::unique_ptr<State> state_;
};

}  // namespace oraclegs
