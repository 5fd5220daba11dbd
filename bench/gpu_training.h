#pragma once
// Iterations as the trainer asks a GPU's TrainDevice for them, on a synthetic scene: what gpu_bench times. On the
// tests' emulated device everything runs too, and takes no time.

#include <memory>

#include "bench/gpu_table.h"
#include "oraclegs/core/cuda/device_array.h"
#include "oraclegs/train/train_device.h"

namespace oraclegs {

struct GpuScene {
  int64_t gaussians = 1'000'000;
  int width = 1237, height = 822;  ///< pixels
};

Camera CameraOf(const GpuScene& scene);
/// On the CPU.
Gaussians GaussiansOf(const GpuScene& scene);

/// L1 + SSIM, opacity noise, all SH coefficients, MCMC's noise; as late in a run as learning rates are smallest, with
/// large second moments, so that every iteration works on the same state. No growth.
class GpuTraining {
 public:
  /// Errors as MakeCudaTrainDevice.
  GpuTraining(const GpuScene& scene, Device device);

  /// Medians over `passes` iterations of each kind.
  GpuTimes Measure(int passes);
  GpuWork Work() const;
  /// Of the rasteriser.
  int64_t scratch_bytes() const;

 private:
  Iteration Next();
  RenderOutput Forward(const Iteration& iteration, const Buffer<float>& factors);
  Buffer<float> Factors(const Iteration& iteration);
  void Send();
  void TimeStages(int passes, GpuTimes* times);
  void TimeWhole(int passes, GpuTimes* times);
  void TimeRefine(int passes, GpuTimes* times);

  GpuScene scene_;
  TrainOptions options_;
  std::unique_ptr<ViewLoss> view_loss_;
  std::unique_ptr<TrainDevice> train_;
  TrainedModel model_;
  int64_t number_;
};

/// Bytes a second of copying `bytes` from device memory to device memory, both ways counted; the median of eight.
double MeasureBandwidth(int64_t bytes);

}  // namespace oraclegs
