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
#include "oraclegs/train/timings.h"
#include "oraclegs/train/train_device.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

struct TrainResult {
  int64_t iterations = 0;
  double seconds = 0;    ///< training time, summed over resumed runs
  int64_t steps = 0;     ///< iterations of this Run alone; 0 when the checkpoint of the last iteration was restored
  TrainTimings timings;  ///< means over `steps`
};

/// When and where to save. An empty folder saves nothing.
struct CheckpointPolicy {
  std::filesystem::path dir;
  int64_t every = 0;       ///< iterations; 0 = only on an interrupt
  nlohmann::json options;  ///< stored, compared on resume
};

/// Inputs of a training.
struct TrainSetup {
  TrainOptions options;
  uint64_t seed = 0;
  std::array<float, 3> background{};
  TrainingData data;
  Gaussians start;                ///< on the CPU
  MethodParts parts = {};         ///< what a method does beside the view
  DensifierMaker densifier = {};  ///< empty = that of 3DGS-MCMC
  /// Seed of the order of the views and of random backgrounds; nullopt = `seed`.
  std::optional<uint64_t> view_seed = {};
};

/// 3DGS-MCMC on photos, on proposals with the probability of the schedule, and on depth where a view has it. One
/// iteration: learning rate, SH degree -> view -> render -> loss -> backward -> Adam step -> relocate, add -> noise.
/// Adam goes before relocation (the order of [Ye 2025], docs/method.md#one-iteration). The last iteration makes neither
/// a step nor noise. The loss is the view's (train/view_loss.h) and the regularizers.
class Trainer {
 public:
  /// Trains on the CPU. Throws ShapeError or UsageError before any work.
  Trainer(const TrainOptions& options, uint64_t seed, std::array<float, 3> background, TrainingData data,
          Gaussians start);
  /// Trains on the device that `make_device` makes; also throws RunError when its memory does not suffice.
  Trainer(TrainSetup setup, const TrainDeviceMaker& make_device);
  ~Trainer();

  /// Continues from this checkpoint instead of from the start. Throws InputError when it does not fit, for example by
  /// the number of photos or proposals.
  void Restore(const Checkpoint& checkpoint);

  /// Runs the remaining iterations. Notes once when there are proposals but no LPIPS. On an interrupt saves a
  /// checkpoint and throws Interrupted. Throws OutOfMemory when the device's memory ends during training, and Diverged
  /// when a loss or a parameter is not finite; both name the last checkpoint, which is complete. `observer` may be
  /// empty.
  TrainResult Run(const CheckpointPolicy& policy, const Listener& listener, const TrainObserver& observer = {});

  /// Runs one iteration and returns the loss. For tests and benchmarks.
  double Step();

  /// Keeps the Gaussians of these rows, with their moments, between iterations.
  void Keep(const std::vector<int64_t>& rows);

  /// The model, on the device of the training.
  const Gaussians& gaussians() const;
  int64_t iteration() const;
  /// Maps from the render to each photo's colors; empty unless the exposure is trained.
  std::vector<ExposureMap> exposures() const;
  /// Means over the iterations since the last Run or Restore began, or since construction; `total` is filled by Run.
  TrainTimings MeanTimings() const;
  /// Timings of the last iteration, without `total`. On a GPU this waits for it, and `loss` and `refine` are the times
  /// to queue the work; MeanTimings has only these two and `total` there.
  TrainTimings LastTimings() const;
  RenderStats LastStats() const;
  Checkpoint MakeCheckpoint() const;

 private:
  struct State;
  TrainResult RunToTheEnd(const CheckpointPolicy& policy, const Listener& listener, const TrainObserver& observer);

  std::unique_ptr<State> state_;
};

}  // namespace oraclegs
