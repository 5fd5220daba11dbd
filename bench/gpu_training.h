#pragma once
// Iterations as the trainer asks a GPU's TrainDevice for them: what gpu_bench times. On the tests' emulated device
// everything runs too, and takes no time.

#include <memory>

#include "bench/gpu_scene.h"
#include "bench/gpu_table.h"
#include "oraclegs/train/loss_terms.h"
#include "oraclegs/train/train_device.h"

namespace oraclegs {

/// L1 + SSIM, regularizers, opacity noise, all SH coefficients, MCMC's noise; as late in a run as learning rates are
/// smallest, with large second moments, so that every iteration works on the same state. No growth. The target of each
/// view is the mirrored render of the first one.
class GpuTraining {
 public:
  /// Errors as MakeCudaTrainDevice.
  GpuTraining(const GpuScene& scene, Device device, ShMoments sh_moments = ShMoments::kFull);
  GpuTraining(const GpuTraining&) = delete;  // the device knows the plan by its address
  GpuTraining& operator=(const GpuTraining&) = delete;

  /// Medians over `passes` iterations of each kind.
  GpuTimes Measure(int passes);
  GpuWork Work() const;
  /// Of the rasterizer.
  int64_t scratch_bytes() const;

 private:
  Iteration Next();
  RenderOutput Forward(const Iteration& iteration, const Buffer<float>& factors);
  Buffer<float> Factors(const Iteration& iteration);
  void Send();
  void TimeStages(int passes, GpuTimes* times);
  void TimeWhole(int passes, GpuTimes* times);
  void TimeRefine(int passes, GpuTimes* times);

  TrainOptions options_;
  LossPlan plan_;
  double pixels_;
  std::unique_ptr<TrainDevice> train_;
  TrainedModel model_;
  int64_t number_;
};

/// Bytes a second of copying `bytes` from device memory to device memory, both ways counted; the median of eight.
double MeasureBandwidth(int64_t bytes);

}  // namespace oraclegs
