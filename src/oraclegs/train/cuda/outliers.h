#pragma once
// Outliers (train/outliers.h) on a GPU.

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/gaussians/gaussian_rows.h"
#include "oraclegs/loss/cuda/device_image.h"

namespace oraclegs::cuda {

/// A view that has depth.
struct DepthView {
  double cam_from_world[12];  ///< 3x4, row by row
  double fx, fy, cx, cy;
  int width, height;
  const float* inv_depth;  ///< [H,W]
  DeviceImage depth_mask;  ///< [H,W]
};

/// Input of RunPruneFloaters, all in device memory.
struct FloatersInput {
  GaussianRows params;
  int64_t count = 0;
  const DepthView* views = nullptr;
  int num_views = 0;
  uint8_t* floats = nullptr;  ///< [count] scratch
  int* counts = nullptr;      ///< [2] receives the numbers of living Gaussians and of floaters among them
};

/// Queues the pruning. Does nothing when no Gaussian would be left alive.
void RunPruneFloaters(const FloatersInput& in, cudaStream_t stream);

/// Input of RunCapScales, all in device memory.
struct ScaleCapInput {
  GaussianRows params;
  int64_t count = 0;
  const float* centers = nullptr;  ///< [num_centers,3], of the photos' cameras
  int num_centers = 0;
  float log_share = 0;  ///< ln of (largest scale / distance)
};

/// Queues the cap. Does nothing without centers.
void RunCapScales(const ScaleCapInput& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
