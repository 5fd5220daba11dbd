#pragma once
// Iterations as the trainer asks them of a GPU's TrainDevice, for the times of gpu_bench. On the tests' emulated device
// everything runs, too, and takes no time.

#include <memory>

#include "bench/gpu_scene.h"
#include "bench/gpu_table.h"
#include "oraclegs/train/loss_terms.h"
#include "oraclegs/train/train_device.h"

namespace oraclegs {

/// A training with L1 + SSIM, regularizers, opacity noise, all SH coefficients and MCMC's noise; at the end of the
/// schedule, where learning rates are smallest, with large second moments, so that every iteration works on the same
/// state. No growth. The target of each view is the mirrored render of the first one.
class GpuTraining {
 public:
  /// Throws as MakeCudaTrainDevice.
  GpuTraining(const GpuScene& scene, Device device, ShMoments sh_moments = ShMoments::kFull);
  GpuTraining(const GpuTraining&) = delete;  // the device knows the plan by its address
  GpuTraining& operator=(const GpuTraining&) = delete;

  /// Measures medians over `passes` iterations of each kind.
  GpuTimes Measure(int passes);
  GpuWork Work() const;
  /// Bytes of the rasterizer's scratch memory.
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

/// Measures bytes per second of copying `bytes` within device memory, reads and writes counted; the median of eight.
double MeasureBandwidth(int64_t bytes);

}  // namespace oraclegs
