#pragma once
// What the trainer asks of the device that the Gaussians lie on; make_train_device.h makes one.

#include <functional>
#include <memory>

#include "oraclegs/render/render.h"
#include "oraclegs/train/adam.h"
#include "oraclegs/train/exposure.h"
#include "oraclegs/train/loss_terms.h"
#include "oraclegs/train/opacity_factors.h"
#include "oraclegs/train/term_sums.h"

namespace oraclegs {

class MethodPart;  // train/method_part.h

/// What training moves.
struct TrainedModel {
  Gaussians gaussians;
  Adam adam{0};
};

/// What of one iteration is the same on every device.
struct Iteration {
  uint64_t seed = 0;
  int64_t number = 0;  ///< from 1
  SampledView view{};
  LearningRates rates;
  int sh_degree = 0;
  bool moves = true;              ///< false in the last iteration
  bool refines = false;           ///< relocates and grows
  bool resets_opacities = false;  ///< of --densify adaptive
  bool caps_scales = false;
};

inline constexpr double kLossSmoothing = 0.9;  ///< share of the past in the loss that is shown

struct LossReport {
  double last = 0;      ///< of the last iteration: its view's and the regularizers'
  double smoothed = 0;  ///< over the iterations
};

/// A device. An iteration is RunParts, OpacityFactors, the rasterizer's Forward, LossOfView, BackwardAndStep and, where
/// it has them, CapScales and Refine, on a model that Upload made. Errors of training that diverges (RunError) may come
/// as late as Loss.
class TrainDevice {
 public:
  virtual ~TrainDevice() = default;

  virtual Rasterizer& rasterizer() = 0;
  /// The rasterizer's timings of this iteration as far as they are known without waiting; all 0 where none is.
  virtual RenderTimings TimingsSoFar() const = 0;

  /// The model on the device, in memory of its own, with room to grow. Without moments it gets zero ones.
  virtual TrainedModel Upload(const TrainedModel& host) = 0;
  /// A copy in the host's memory.
  virtual TrainedModel Download(const TrainedModel& model) const = 0;

  /// What parts of other methods do before the iteration's view (MethodPart::BeforeView).
  virtual void RunParts(const Iteration&, TrainedModel*) {}

  /// [n]; valid until the next call.
  virtual Buffer<float> OpacityFactors(const OpacityPerturbation& perturbation, int64_t n) = 0;
  /// dL/d(render) of the iteration's view; valid until the next call.
  virtual RenderGrads LossOfView(const Iteration& iteration, const RenderOutput& out) = 0;
  /// Everything between the gradient of the image and the moved Gaussians: backward, regularizers, Adam and, unless the
  /// iteration refines, noise. Closes the iteration's loss.
  virtual void BackwardAndStep(const Iteration& iteration, const RenderGrads& upstream, TrainedModel* model) = 0;
  /// scale_cap.h with --largest-scale, in iterations that cap scales, before Refine.
  virtual void CapScales(TrainedModel* model) = 0;
  /// What --densify does in iterations that refine or reset opacities: relocation, growth and noise, or clones, splits,
  /// removals and resets.
  virtual void Refine(const Iteration& iteration, TrainedModel* model) = 0;
  /// What of earlier iterations the next Refine goes by, on the CPU; empty where that is nothing.
  virtual ScreenGradients densify_state() const { return {}; }
  /// Of a model of so many Gaussians. Throws InputError when the state is of another number.
  virtual void RestoreDensify(const ScreenGradients&, int64_t) {}
  /// The same anew.
  virtual void BeginDensify(int64_t) {}

  /// Waits for the device. Throws RunError when the loss of an iteration since the last call was not finite.
  virtual LossReport Loss() = 0;
  virtual void RestoreLoss(double smoothed) = 0;
  /// Of all iterations since this was made. A device that would have to wait for them keeps none.
  virtual TermSums Terms() const { return {}; }

  /// Empty where they are not trained.
  virtual ExposureState exposures() const = 0;
  /// Throws InputError when the state is of another number of photos; does nothing where they are not trained.
  virtual void RestoreExposures(const ExposureState& state) = 0;
};

/// `options` are settled, `start` is how many Gaussians there will be at first; `plan` outlives the device.
struct TrainDeviceSetup {
  const TrainOptions& options;
  const LossPlan& plan;
  int64_t start = 0;
  std::vector<std::shared_ptr<MethodPart>> parts = {};
};
/// Makes the device of a run.
using TrainDeviceMaker = std::function<std::unique_ptr<TrainDevice>(const TrainDeviceSetup& setup)>;

}  // namespace oraclegs
