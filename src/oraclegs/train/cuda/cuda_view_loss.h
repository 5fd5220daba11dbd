#pragma once
// The terms of an iteration's loss, evaluated on a GPU without transfers to the host.

#include "oraclegs/core/cuda/device_array.h"
#include "oraclegs/loss/cuda/photometric.h"
#include "oraclegs/render/render.h"
#include "oraclegs/train/cuda/device_views.h"
#include "oraclegs/train/cuda/exposure.h"
#include "oraclegs/train/cuda/loss_accumulator.h"
#include "oraclegs/train/exposure.h"

namespace oraclegs::cuda {

class CudaViewLoss {
 public:
  /// Takes the plan's `views` on `device` and allocates all memory that an iteration needs.
  CudaViewLoss(const LossPlan& plan, DeviceViews views, Device device);

  /// Queues the loss of the view and appends its terms to `sums`. Returns gradients as ViewLoss does.
  RenderGrads operator()(const SampledView& sampled, int64_t iteration, const RenderOutput& out, LossSums* sums);

  const DeviceViews& views() const { return views_; }
  ExposureState exposures() const;
  /// Restores trained exposure maps. Throws InputError when the state is of another number of photos; does nothing
  /// where none are trained.
  void RestoreExposures(const ExposureState& state);

 private:
  struct Rendered;

  void Queue(const LossTerm& term, const Rendered& rendered, RenderGrads* grads, LossSums* sums);
  void QueuePhotometric(const LossTerm& term, const Rendered& rendered, LossSums* sums);
  void QueueExposure(const LossTerm& term, const Rendered& rendered, LossSums* sums);
  Buffer<float> ShownThrough(int exposure, const Buffer<float>& image);

  const LossPlan& plan_;
  DeviceViews views_;
  Buffer<float> grad_image_, shown_, grad_inv_depth_, grad_alpha_;  // of the largest view
  DeviceArray<float> derivatives_{"the gradients of the image"};
  DeviceArray<PhotometricSums> photometric_sums_{"the sums of the loss"};
  DeviceArray<double> depth_sums_{"the sums of the loss"}, alpha_sums_{"the sums of the loss"},
      exposure_sums_{"the sums of the loss"}, exposure_regularizer_{"the sums of the loss"};
  DeviceArray<float> maps_{"exposure maps"}, m_{"exposure maps"}, v_{"exposure maps"};
  DeviceArray<int64_t> steps_{"exposure maps"};
  ExposureRows rows_;
};

}  // namespace oraclegs::cuda
