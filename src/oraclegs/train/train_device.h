#pragma once
// Interface of the device that trains the Gaussians, and the makers of one.

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "oraclegs/render/render.h"
#include "oraclegs/train/adam.h"
#include "oraclegs/train/densify.h"
#include "oraclegs/train/exposure.h"
#include "oraclegs/train/loss_terms.h"
#include "oraclegs/train/observer.h"
#include "oraclegs/train/opacity_factors.h"

namespace oraclegs {

class MethodPart;  // train/method_part.h

/// The state that training moves.
struct TrainedModel {
  Gaussians gaussians;
  Adam adam{0};
};

/// Values of one iteration that are the same on every device.
struct Iteration {
  uint64_t seed = 0;
  int64_t number = 0;  ///< from 1
  SampledView view{};
  LearningRates rates;
  int sh_degree = 0;
  bool moves = true;     ///< false in the last iteration
  bool refines = false;  ///< Gaussians are relocated and added
  bool caps_scales = false;
};

inline constexpr double kLossSmoothing = 0.9;  ///< weight of the past in the loss that is shown

struct LossReport {
  double last = 0;      ///< loss of the last iteration's view plus regularizers
  double smoothed = 0;  ///< exponential mean over the iterations
};

/// A device. An iteration is RunParts, OpacityFactors, the rasterizer's Forward, LossOfView, BackwardAndStep and, where
/// it has them, CapScales and Refine, on a model that Upload made. Errors of diverging training (RunError) may be
/// raised as late as in Loss.
class TrainDevice {
 public:
  virtual ~TrainDevice() = default;

  virtual Rasterizer& rasterizer() = 0;
  /// The rasterizer's timings of this iteration that are known without waiting; 0 for the others.
  virtual RenderTimings TimingsSoFar() const = 0;

  /// Copies the model to memory on the device that has room to grow. A model without moments gets zero ones.
  virtual TrainedModel Upload(const TrainedModel& host) = 0;
  /// Copies the model to the host's memory.
  virtual TrainedModel Download(const TrainedModel& model) const = 0;

  /// Makes another rasterizer, for renders beside the iteration's view.
  virtual std::unique_ptr<Rasterizer> NewRasterizer() const = 0;

  /// Runs the parts of the method before the iteration's view (MethodPart::Remove and BeforeView).
  virtual void RunParts(const Iteration& iteration, TrainedModel* model) = 0;

  /// Draws the opacity factors, [n]; valid until the next call.
  virtual Buffer<float> OpacityFactors(const OpacityPerturbation& perturbation, int64_t n) = 0;
  /// dL/d(render) of the iteration's view; valid until the next call.
  virtual RenderGrads LossOfView(const Iteration& iteration, const RenderOutput& out) = 0;
  /// Runs everything between the gradient of the image and the moved Gaussians: backward, regularizers, Adam and,
  /// unless the iteration refines, noise. Closes the iteration's loss.
  virtual void BackwardAndStep(const Iteration& iteration, const RenderGrads& upstream, TrainedModel* model) = 0;
  /// Caps the scales (outliers.h with --set largest-scale), in iterations that do so, before Refine.
  virtual void CapScales(TrainedModel* model) = 0;
  /// Runs the densifier where it acts in this iteration.
  virtual void Refine(const Iteration& iteration, TrainedModel* model) = 0;
  virtual Densifier& densifier() = 0;

  /// Waits for the device. Throws RunError when the loss of an iteration since the last call was not finite.
  virtual LossReport Loss() = 0;
  virtual void RestoreLoss(double smoothed) = 0;
  /// Sums over all iterations since construction. A device that would have to wait for them keeps none.
  virtual TermSums Terms() const { return {}; }

  /// State of the exposure maps; empty where they are not trained.
  virtual ExposureState exposures() const = 0;
  /// Restores the exposure maps. Throws InputError when the state is of another number of photos; does nothing where
  /// they are not trained.
  virtual void RestoreExposures(const ExposureState& state) = 0;

  /// Memory of the device that the training was expected to need before it began, bytes; 0 = nobody knows.
  virtual int64_t expected_bytes() const { return 0; }
};

/// Inputs of a device. `start` is the first number of Gaussians; `plan` outlives the device.
struct TrainDeviceSetup {
  const TrainOptions& options;
  const LossPlan& plan;
  int64_t start = 0;
  std::vector<std::shared_ptr<MethodPart>> parts = {};
  DensifierMaker densifier = {};  ///< empty = that of 3DGS-MCMC
};
/// Makes the device of a run.
using TrainDeviceMaker = std::function<std::unique_ptr<TrainDevice>(const TrainDeviceSetup& setup)>;

/// Edits a model that lies on any device: calls `edit` with the model on the host: with the model itself on a CPU, else
/// with a copy that replaces it afterwards, in the device's memory where that has room (Buffer::GrownTo).
void OnHost(TrainedModel* model, const std::function<void(TrainedModel*)>& edit);

/// Keeps the Gaussians of these rows, with their moments, in this order. On a CPU in new memory, on a GPU in the memory
/// that there is where that has room.
void KeepRows(const std::vector<int64_t>& rows, Gaussians* gaussians, Adam* adam);

/// Makes the training device of this name. Throws UsageError when this build has none for it, RunError when its memory
/// does not suffice.
std::unique_ptr<TrainDevice> MakeTrainDevice(Device device, const TrainDeviceSetup& setup);

/// Makes the one of the CPU.
std::unique_ptr<TrainDevice> MakeCpuTrainDevice(const TrainDeviceSetup& setup);

namespace cuda {

/// Makes the one of the GPU of this name, which becomes the current one (cuda/cuda_train_device.cpp). Throws UsageError
/// when there is none, RunError when its memory does not suffice for the estimate (memory_estimate.h).
std::unique_ptr<TrainDevice> MakeCudaTrainDevice(Device device, const TrainDeviceSetup& setup);

}  // namespace cuda

}  // namespace oraclegs
