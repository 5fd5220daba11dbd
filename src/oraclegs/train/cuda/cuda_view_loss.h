#pragma once
// What train/view_loss.h works out, on a GPU: the views lie there, and nothing comes back.

#include <array>
#include <vector>

#include "oraclegs/core/cuda/device_array.h"
#include "oraclegs/loss/cuda/photometric.h"
#include "oraclegs/train/cuda/exposure.h"
#include "oraclegs/train/cuda/floaters.h"
#include "oraclegs/train/cuda/loss_accumulator.h"
#include "oraclegs/train/train_device.h"

namespace oraclegs::cuda {

/// A view's pictures, as bytes where those hold them exactly.
struct DeviceViewPictures {
  Buffer<float> image, confidence, inv_depth, depth_mask, alpha;  ///< as TrainView's
  Buffer<float> lpips_target;  ///< the image in floats, one object for all iterations, which the network's cache knows it by
  double mean_confidence = 1;

  std::array<Buffer<float>*, 6> Tensors() { return {&image, &confidence, &inv_depth, &depth_mask, &alpha, &lpips_target}; }
  int64_t bytes() const;
};

/// Packed pictures of all views of a run.
class DeviceViews {
 public:
  /// On the CPU.
  explicit DeviceViews(const ViewLoss& view_loss);
  void MoveTo(Device device);

  const DeviceViewPictures& At(const SampledView& view, bool coarse) const;
  /// The full-size photographs that have depth, with the pictures that lie on the device.
  std::vector<DepthView> DepthViews(const std::vector<TrainView>& photographs) const;
  int64_t bytes() const;

 private:
  std::vector<DeviceViewPictures> groups_[2][2];  // kind, coarse
};

class CudaViewLoss {
 public:
  /// `views` on `device`. All memory that an iteration needs is taken here.
  CudaViewLoss(const ViewLoss& view_loss, DeviceViews views, Device device);

  /// Queues the loss of the view; adds what it consists of to `terms`.
  RenderGrads operator()(const Iteration& iteration, const RenderOutput& out, LossTerms* terms);

  const DeviceViews& views() const { return views_; }
  ExposureState exposures() const;
  void RestoreExposures(const ExposureState& state);

 private:
  void AddPhotometric(const Iteration& iteration, const Buffer<float>& image, LossTerms* terms);
  void StepExposure(const Iteration& iteration, const Buffer<float>& image, LossTerms* terms);
  void AddLpips(const Iteration& iteration, const Buffer<float>& image, LossTerms* terms);
  Buffer<float> AddDepth(const Iteration& iteration, const Buffer<float>& inv_depth, LossTerms* terms);
  Buffer<float> AddAlpha(const Iteration& iteration, const Buffer<float>& alpha, LossTerms* terms);
  bool HasExposure(const Iteration& iteration) const {
    return rows_.views > 0 && iteration.view.kind == ViewKind::kPhotograph;
  }
  const DeviceViewPictures& Pictures(const Iteration& iteration) const {
    return views_.At(iteration.view, view_loss_.IsCoarse(iteration.number));
  }

  const ViewLoss& view_loss_;
  DeviceViews views_;
  int64_t iterations_;
  Buffer<float> grad_image_, shown_, grad_inv_depth_, grad_alpha_;  // of the largest view
  DeviceArray<float> slopes_{"the gradients of the picture"};
  DeviceArray<PhotometricSums> photometric_sums_{"the sums of the loss"};
  DeviceArray<double> depth_sums_{"the sums of the loss"}, alpha_sums_{"the sums of the loss"},
      exposure_sums_{"the sums of the loss"}, pull_{"the sums of the loss"};
  DeviceArray<float> maps_{"exposure maps"}, m_{"exposure maps"}, v_{"exposure maps"};
  DeviceArray<int64_t> steps_{"exposure maps"};
  ExposureRows rows_;
};

/// The most pixels, and tiles of the photometric loss, that any view has.
struct LargestView {
  int64_t pixels = 0, tiles = 0;
};
LargestView LargestOf(const ViewLoss& view_loss);

}  // namespace oraclegs::cuda
